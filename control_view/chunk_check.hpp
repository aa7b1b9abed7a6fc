#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "control_view/scene_bytes.hpp"
#include "protocol/messages.hpp"

namespace sightline {

/// Chunks of one upload that are to be compared with the digests of its offer.
struct ChunkCheck {
  struct Chunk {
    std::uint32_t index = 0;
    SceneDigest digest{};
  };
  SceneDigest scene_digest{};
  SceneBytes bytes;
  std::vector<Chunk> chunks;
};

struct CheckedChunks {
  SceneDigest scene_digest{};
  std::vector<std::uint32_t> right, wrong;
};

[[nodiscard]] CheckedChunks check_chunks(const ChunkCheck& check);

}  // namespace sightline
