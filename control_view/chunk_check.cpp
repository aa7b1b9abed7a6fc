#include "control_view/chunk_check.hpp"

namespace sightline {

CheckedChunks check_chunks(const ChunkCheck& check) {
  CheckedChunks checked{check.scene_digest, {}, {}};
  for (const auto& [index, digest] : check.chunks) {
    const bool is_right = digest_of(check.bytes.chunk(index)) == digest;
    (is_right ? checked.right : checked.wrong).push_back(index);
  }
  return checked;
}

}  // namespace sightline
