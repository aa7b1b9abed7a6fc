#include "control_view/engines/merge_passes.hpp"

#include <optional>

namespace sightline {
namespace {

/// Which of two coincident objects drawing in the one order would have left; nothing when it depends on which
/// of their primitives meet.
std::optional<ItemCode> first_drawn(ItemCode a, ItemCode b, const gl::GpuScene& scene) {
  if (a == k_background_code || b == k_background_code) return k_background_code;
  const gl::DrawPositions of_a = scene.opaque_positions(object_of(a));
  const gl::DrawPositions of_b = scene.opaque_positions(object_of(b));
  if (of_a.last < of_b.first) return a;
  if (of_b.last < of_a.first) return b;
  return {};
}

}  // namespace

Merge merge_pass(const CodesAndDepth& image, ImageSize size, const ScreenBox& box,
                 std::span<const ItemCode> after_codes, std::span<const float> after_depth,
                 const gl::GpuScene& scene) {
  Merge outcome = Merge::done;
  // Coincident surfaces meet in many pixels: the verdict on one pair mostly serves the next.
  ItemCode last_before = k_background_code, last_after = k_background_code, last_winner = k_background_code;
  const std::uint32_t width = box.right - box.left;
  for (std::uint32_t y = box.bottom; y < box.top; ++y) {
    ItemCode* codes = image.codes.data() + std::size_t{y} * size.width + box.left;
    float* depth = image.depth.data() + std::size_t{y} * size.width + box.left;
    const std::size_t row = std::size_t{y - box.bottom} * width;
    for (std::uint32_t x = 0; x < width; ++x) {
      const ItemCode before = codes[x], after = after_codes[row + x];
      if (before == after) continue;
      if (after_depth[row + x] > depth[x]) {
        codes[x] = after;
        depth[x] = after_depth[row + x];
        continue;
      }
      if (before != last_before || after != last_after) {
        const std::optional<ItemCode> winner = first_drawn(before, after, scene);
        if (!winner) return Merge::undecided;
        last_before = before;
        last_after = after;
        last_winner = *winner;
      }
      codes[x] = last_winner;
      if (last_winner != after) outcome = Merge::settled_ties;
    }
  }
  return outcome;
}

}  // namespace sightline
