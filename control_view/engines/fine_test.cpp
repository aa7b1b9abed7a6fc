#include "control_view/engines/fine_test.hpp"

#include <array>

#include "common/widest_axis.hpp"

namespace sightline {
namespace {

/// A piece that covers no more than this, pixels, is not halved: its rectangle is close enough.
constexpr std::uint32_t k_small_side = 4;

}  // namespace

bool may_show_finely(const BoxProjector& projector, const DepthHierarchy& depth, const Aabb& box) {
  const BoxProjector::Rounding rounding = projector.rounding_in(box);
  std::array<Aabb, k_most_pieces> stack;
  std::size_t waiting = 0;
  stack[waiting++] = box;
  for (int tested = 0; waiting > 0; ++tested) {
    if (tested == k_most_pieces) return true;
    const Aabb piece = stack[--waiting];
    const auto screen = projector.project(piece, rounding);
    if (!screen || !depth.may_show(*screen)) continue;
    const bool small =
        screen->right - screen->left <= k_small_side && screen->top - screen->bottom <= k_small_side;
    const int axis = widest_axis(projector.lengths_of(piece));
    const float middle = 0.5f * (piece.min[axis] + piece.max[axis]);
    const bool divisible = piece.min[axis] < middle && middle < piece.max[axis];
    if (small || !divisible || waiting + 2 > stack.size()) return true;
    stack[waiting] = stack[waiting + 1] = piece;
    stack[waiting++].min[axis] = middle;
    stack[waiting++].max[axis] = middle;
  }
  return false;
}

}  // namespace sightline
