#pragma once

#include <cstdint>
#include <span>

#include "common/gl/gpu_scene.hpp"
#include "common/object_id.hpp"
#include "common/view.hpp"
#include "control_view/engines/screen_box.hpp"

namespace sightline {

/// An item buffer in memory: codes and reversed depth, rows from the bottom.
struct CodesAndDepth {
  std::span<ItemCode> codes;
  std::span<float> depth;
};

enum class Merge : std::uint8_t {
  done,
  settled_ties,  ///< done, and some pixel is not what the pass left there
  undecided      ///< two objects coincide whose primitives take turns in the one order: draw them in it
};

/// Brings `image` (as it was before gl::ItemBuffer::draw_more, `size` large) to what drawing everything in
/// the one order would have given, from what the pass left in the pixels of `box`: `after`, as large as the
/// box.
///
/// Where the pass came nearer, it owns the pixel. Where the depth is what it was, the object that comes first
/// in the one order does, and background before all: a fragment on the far plane is not in front of nothing.
[[nodiscard]] Merge merge_pass(const CodesAndDepth& image, ImageSize size, const ScreenBox& box,
                               std::span<const ItemCode> after_codes, std::span<const float> after_depth,
                               const gl::GpuScene& scene);

}  // namespace sightline
