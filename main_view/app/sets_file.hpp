#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "common/object_id.hpp"

namespace sightline {

/// What one client would draw in one frame of a path, by object.
struct FrameSet {
  std::uint32_t frame = 0;    ///< of the path, from 0
  bool everything = false;    ///< the client had no answer: all that its view frustum holds
  std::vector<ObjectId> ids;  ///< ascending, each once
};

/// Reads a CSV of two columns, `frame,ids`: a frame's number, and object ids with spaces between them, in any
/// order, or * for everything. Frames ascend. Throws InputError naming file and line for anything else, for a
/// frame from `frame_count` on and for an id from `object_count` on.
[[nodiscard]] std::vector<FrameSet> read_frame_sets(const std::filesystem::path& file,
                                                    std::uint32_t frame_count, std::uint32_t object_count);

}  // namespace sightline
