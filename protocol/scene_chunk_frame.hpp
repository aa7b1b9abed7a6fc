#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "protocol/codec.hpp"
#include "protocol/frame.hpp"
#include "protocol/messages.hpp"

namespace sightline {

/// A SceneChunk whose bytes lie elsewhere: a scene is too large to be copied at every step of its way.
struct SceneChunkView {
  SceneDigest scene_digest{};
  std::uint32_t index = 0;
  std::span<const std::uint8_t> bytes;

  SceneChunkView() = default;
  SceneChunkView(const SceneDigest& digest, std::uint32_t chunk_index,
                 std::span<const std::uint8_t> chunk_bytes) noexcept
      : scene_digest(digest), index(chunk_index), bytes(chunk_bytes) {}
  SceneChunkView(const SceneChunk& chunk) noexcept
      : SceneChunkView(chunk.scene_digest, chunk.index, chunk.bytes) {}
};

/// The same frame as encode(SceneChunk{...}), with one copy of the bytes.
[[nodiscard]] Frame encode_scene_chunk(const SceneChunkView& chunk);

/// The chunk that decode() would give for this frame, with its bytes left in the frame. Empty where decode()
/// would give another message or a reason, and for a frame that is not aligned to 8 bytes; decode() tells.
/// Safe on untrusted bytes: checked as decode() checks.
[[nodiscard]] std::optional<SceneChunkView> view_scene_chunk(std::span<const std::byte> frame,
                                                             const DecodeLimits& limits = {});

}  // namespace sightline
