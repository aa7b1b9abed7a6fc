// Included by the kernels only: SIGHTLINE_LANES names the namespace of their instruction set.
#pragma once

#include <cmath>

#include "control_view/engines/raster/kernel.hpp"
#include "control_view/engines/raster/lanes.hpp"

namespace sightline::raster::SIGHTLINE_LANES {

/// The image of a region while it is drawn, and the hierarchy over it: of each block a depth that nothing in
/// it is farther than.
class Target {
 public:
  Target(const RasterRegion& region, const RegionMemory& memory)
      : x0(region.x),
        y0(region.y),
        width(region.width),
        height(region.height),
        blocks_x((region.width + k_block - 1) / k_block),
        blocks_y((region.height + k_block - 1) / k_block),
        depth(memory.depth),
        rank(memory.rank),
        blended_mark(memory.blended_mark),
        far_(memory.block_far),
        state_(memory.block_state) {
    std::memset(far_, 0, sizeof(float) * static_cast<std::size_t>(blocks_x * blocks_y));
    std::memset(state_, 0, static_cast<std::size_t>(blocks_x * blocks_y));
  }

  /// Whether nothing at `nearest` or farther shows in the block. Finds its farthest depth anew where that may
  /// have changed.
  [[nodiscard]] bool hides_block(int block, float nearest) {
    if (nearest < far_[block]) return true;
    if (state_[block] != BlockState::dirty) return false;
    find_far(block);
    return nearest < far_[block];
  }
  /// The noted depths of this block and those after it; readable beyond the last one for a vector.
  [[nodiscard]] const float* far_from(int block) const { return far_ + block; }
  [[nodiscard]] bool untouched(int block) const { return state_[block] == BlockState::untouched; }
  void mark_dirty(int block) { state_[block] = BlockState::dirty; }

  /// Makes the block's pixels say what is there: nothing.
  void open(int block) {
    if (state_[block] != BlockState::untouched) return;
    state_[block] = BlockState::clean;
    float* const d = depth + block * k_block_pixels;
    std::int32_t* const r = rank + block * k_block_pixels;
    for (int i = 0; i < k_block_pixels; i += k_lanes) {
      store(d + i, all(0.0f));
      store(r + i, all(0));
    }
    const int left = (block % blocks_x) * k_block;
    const int bottom = (block / blocks_x) * k_block;
    if (left + k_block <= width && bottom + k_block <= height) return;
    for (int i = 0; i < k_block_pixels; ++i) {
      const bool outside = left + i % k_block >= width || bottom + i / k_block >= height;
      if (outside) d[i] = HUGE_VALF;
    }
  }

  /// Whether something at `nearest` or farther shows nowhere in these pixels of the region (ends included). A
  /// tie may show.
  [[nodiscard]] bool hides_rectangle(int left, int bottom, int right, int top, float nearest) {
    for (int by = bottom / k_block; by <= top / k_block; ++by) {
      for (int bx = left / k_block; bx <= right / k_block; ++bx) {
        const int block = by * blocks_x + bx;
        if (hides_block(block, nearest)) continue;
        if (untouched(block)) return false;
        const int in_left = left - bx * k_block, in_right = right - bx * k_block;
        const int in_bottom = bottom - by * k_block, in_top = top - by * k_block;
        if (!hides_in_block(block, in_left, in_bottom, in_right, in_top, nearest)) return false;
      }
    }
    return true;
  }

  const int x0, y0;  ///< of the region, pixels of the whole image
  const int width, height;
  const int blocks_x, blocks_y;
  float* const depth;
  std::int32_t* const rank;
  std::int32_t* const blended_mark;

 private:
  void find_far(int block) {
    const float* const d = depth + block * k_block_pixels;
    Floats far = load(d);
    for (int i = k_lanes; i < k_block_pixels; i += k_lanes) far = min(far, load(d + i));
    far_[block] = least(far);
    state_[block] = BlockState::clean;
  }

  /// Pixel by pixel; the rectangle may reach beyond the block.
  [[nodiscard]] bool hides_in_block(int block, int left, int bottom, int right, int top,
                                    float nearest) const {
    const int last = k_block - 1;
    if (left <= 0 && bottom <= 0 && right >= last && top >= last)
      return false;  // its farthest pixel is no nearer
    const float* const d = depth + block * k_block_pixels;
    const Ints low = all(left - 1), high = all(right + 1);
    for (int i = 0; i < k_block_pixels; i += k_lanes) {
      const int row = i / k_block;
      if (row + (k_lanes > k_block ? k_lanes / k_block - 1 : 0) < bottom || row > top) continue;
      Ints column = iota() + all(i % k_block);
      Mask inside = (column > low) & (high > column);
      if constexpr (k_lanes > k_block) {
        const Ints lane_row = shift_right<3>(iota()) + all(row);
        column = iota() & all(last);
        inside = (column > low) & (high > column) & (lane_row > all(bottom - 1)) & (all(top + 1) > lane_row);
      }
      if (bits(inside & !(load(d + i) > all(nearest))) != 0) return false;
    }
    return true;
  }

  float* const far_;
  BlockState* const state_;
};

}  // namespace sightline::raster::SIGHTLINE_LANES
