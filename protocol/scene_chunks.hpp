#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/messages.hpp"

namespace sightline {

/// Bytes of every chunk of a scene but the last, which may be shorter.
inline constexpr std::size_t k_scene_chunk_bytes = 262'144;

[[nodiscard]] constexpr std::uint64_t chunk_count_of(std::uint64_t byte_count) noexcept {
  return byte_count / k_scene_chunk_bytes + (byte_count % k_scene_chunk_bytes != 0 ? 1 : 0);
}

/// One chunk's part of the scene's bytes. Requires an index below chunk_count_of(scene.size()).
[[nodiscard]] std::span<const std::uint8_t> chunk_of(std::span<const std::uint8_t> scene,
                                                     std::uint32_t index) noexcept;

/// BLAKE2b of 16 bytes, without a key (Saarinen, Aumasson, "The BLAKE2 Cryptographic Hash and Message
/// Authentication Code", RFC 7693, 2015). Scenes are shared by digest among clients that need not trust each
/// other, so it has to be one that nobody can find a second scene for.
[[nodiscard]] SceneDigest digest_of(std::span<const std::uint8_t> bytes);

/// Digest of an offer's scene: of its chunks' digests in their order, then byte_count (8 bytes), object_count
/// (4) and triangle_count (8), each little-endian. So chunks can be checked one by one against an offer that
/// has been checked as a whole.
[[nodiscard]] SceneDigest scene_digest_of(const SceneOffer& offer);

/// The offer of a scene of these bytes.
[[nodiscard]] SceneOffer offer_of(std::span<const std::uint8_t> scene, std::uint32_t object_count,
                                  std::uint64_t triangle_count);

}  // namespace sightline
