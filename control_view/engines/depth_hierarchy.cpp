#include "control_view/engines/depth_hierarchy.hpp"

#include <algorithm>

namespace sightline {
namespace {

constexpr std::uint32_t k_fine_side = 8;
constexpr std::uint32_t k_coarse_side = 64;

std::uint32_t tiles_over(std::uint32_t pixels, std::uint32_t side) {
  return (pixels + side - 1) / side;
}

/// `out[x]` becomes the least of rows [first, end) at x, then of each `side` neighbours: one row of tiles.
void reduce_rows(const float* rows, std::size_t width, std::uint32_t first, std::uint32_t end,
                 std::uint32_t side, float* scratch, float* tiles) {
  std::copy_n(rows + first * width, width, scratch);
  for (std::uint32_t y = first + 1; y < end; ++y) {
    const float* row = rows + y * width;
    for (std::size_t x = 0; x < width; ++x) scratch[x] = std::min(scratch[x], row[x]);
  }
  std::size_t x = 0;
  for (; x + side <= width; x += side) *tiles++ = *std::min_element(scratch + x, scratch + x + side);
  if (x < width) *tiles = *std::min_element(scratch + x, scratch + width);
}

}  // namespace

void DepthHierarchy::build(std::span<const float> depth, ImageSize size) {
  depth_ = depth;
  size_ = size;
  row_.resize(size.width);
  const auto reduce = [this](const float* from, ImageSize from_size, std::uint32_t side, Level& level) {
    level.columns = tiles_over(from_size.width, side);
    level.rows = tiles_over(from_size.height, side);
    level.farthest.resize(std::size_t{level.columns} * level.rows);
    for (std::uint32_t row = 0; row < level.rows; ++row) {
      reduce_rows(from, from_size.width, row * side, std::min((row + 1) * side, from_size.height), side,
                  row_.data(), level.farthest.data() + std::size_t{row} * level.columns);
    }
  };
  fine_.tile_side = k_fine_side;
  reduce(depth.data(), size, k_fine_side, fine_);
  coarse_.tile_side = k_coarse_side;
  reduce(fine_.farthest.data(), {fine_.columns, fine_.rows}, k_coarse_side / k_fine_side, coarse_);
}

bool DepthHierarchy::may_show(const ScreenBox& box) const noexcept {
  return may_show_in(box, 1);
}

bool DepthHierarchy::may_show_in(const ScreenBox& box, int level_index) const noexcept {
  const Level& level = level_index == 1 ? coarse_ : fine_;
  const std::uint32_t side = level.tile_side;
  for (std::uint32_t row = box.bottom / side; row * side < box.top; ++row) {
    const std::uint32_t bottom = row * side, top = std::min(bottom + side, size_.height);
    for (std::uint32_t column = box.left / side; column * side < box.right; ++column) {
      if (level.farthest[std::size_t{row} * level.columns + column] > box.nearest_depth) continue;
      const std::uint32_t left = column * side, right = std::min(left + side, size_.width);
      // The tile's farthest pixel is in the rectangle when the tile is.
      if (box.left <= left && right <= box.right && box.bottom <= bottom && top <= box.top) return true;
      const ScreenBox part{std::max(left, box.left), std::max(bottom, box.bottom), std::min(right, box.right),
                           std::min(top, box.top), box.nearest_depth};
      if (level_index == 1 ? may_show_in(part, 0) : any_pixel_as_far(part)) return true;
    }
  }
  return false;
}

bool DepthHierarchy::any_pixel_as_far(const ScreenBox& box) const noexcept {
  for (std::uint32_t y = box.bottom; y < box.top; ++y) {
    const float* row = depth_.data() + std::size_t{y} * size_.width;
    for (std::uint32_t x = box.left; x < box.right; ++x) {
      if (row[x] <= box.nearest_depth) return true;
    }
  }
  return false;
}

}  // namespace sightline
