// Included by the kernels only: SIGHTLINE_LANES names the namespace of their instruction set.
#pragma once

#include "control_view/engines/raster/target.hpp"

namespace sightline::raster::SIGHTLINE_LANES {

/// Copies what a region shows into the depth image of the whole view.
inline void copy_depth(const RasterRegion& region, const RegionMemory& memory, const DepthImage& image) {
  const int blocks_x = (region.width + k_block - 1) / k_block;
  for (int y = 0; y < region.height; ++y) {
    float* const to = image.at(region.x, region.y + y);
    const int first_block = y / k_block * blocks_x;
    for (int x = 0; x < region.width; x += k_block) {
      const int block = first_block + x / k_block;
      const float* const from = memory.depth + block * k_block_pixels + y % k_block * k_block;
      const bool untouched = memory.block_state[block] == BlockState::untouched;
      const int columns = region.width - x < k_block ? region.width - x : k_block;
      for (int i = 0; i < columns; ++i) to[x + i] = untouched ? 0.0f : from[i];
    }
  }
}

/// Occluders made smaller: a pixel becomes the farthest of those within a radius, which follows what the
/// nearest of its block may move by. Writes the target's blocks, all of them clean.
///
/// Pixels beyond the image are none to look at: its border holds a depth nearer than anything.
class Eroder {
 public:
  Eroder(Target& target, const ProbeJob& job)
      : target_(target), image_(job.image), radius_(job.radius), rim_(job.rim_blocks) {}

  void erode(RegionMemory& memory) {
    for (int by = 0; by < target_.blocks_y; ++by) {
      for (int bx = 0; bx < target_.blocks_x; ++bx) {
        const int block = by * target_.blocks_x + bx;
        memory.block_state[block] = BlockState::clean;
        const bool in_rim =
            bx < rim_ || by < rim_ || bx >= target_.blocks_x - rim_ || by >= target_.blocks_y - rim_;
        if (in_rim) {
          memory.block_far[block] = HUGE_VALF;
          continue;
        }
        memory.block_far[block] = erode_block(bx, by, target_.depth + block * k_block_pixels);
      }
    }
  }

 private:
  // Vectors of 16 lanes hold a row of 8 and what follows it; shorter ones take turns.
  static constexpr int k_parts = k_lanes < k_block ? k_block / k_lanes : 1;
  static constexpr int k_row = k_block > k_lanes ? k_block : k_lanes;
  static constexpr int k_most_rows = k_block + 2 * k_most_erosion;

  /// Returns the farthest depth of the block's pixels.
  float erode_block(int bx, int by, float* out) {
    const float* const at = image_.at(target_.x0 + bx * k_block, target_.y0 + by * k_block);
    const int r = radius_of(at);
    float rows[k_most_rows][k_row];
    for (int row = -r; row < k_block + r; ++row) {
      for (int part = 0; part < k_parts; ++part) {
        const float* const from = at + row * image_.stride + part * k_lanes;
        Floats least_of = load(from - r);
        for (int i = 1 - r; i <= r; ++i) least_of = min(least_of, load(from + i));
        store(rows[row + r] + part * k_lanes, least_of);
      }
    }
    float row_out[k_row];
    Floats far = all(HUGE_VALF);
    for (int row = 0; row < k_block; ++row) {
      for (int part = 0; part < k_parts; ++part) {
        Floats least_of = load(rows[row] + part * k_lanes);
        for (int i = 1; i <= 2 * r; ++i) least_of = min(least_of, load(rows[row + i] + part * k_lanes));
        store(row_out + part * k_lanes, least_of);
      }
      for (int i = 0; i < k_block; ++i) out[row * k_block + i] = row_out[i];
    }
    for (int i = 0; i < k_block_pixels; i += k_lanes) far = min(far, load(out + i));
    return least(far);
  }

  [[nodiscard]] int radius_of(const float* at) const {
    Floats negative_nearest = all(0.0f);
    for (int row = 0; row < k_block; ++row) {
      for (int part = 0; part < k_parts; ++part) {
        const Floats d = load(at + row * image_.stride + part * k_lanes);
        negative_nearest = min(negative_nearest, select(d > all(1.0f), all(0.0f), all(0.0f) - d));
      }
    }
    const float radius = radius_.at_far_px + radius_.per_depth_px * -least(negative_nearest);
    if (!(radius > 0.0f)) return 0;
    return radius < static_cast<float>(k_most_erosion) ? static_cast<int>(__builtin_floorf(radius + 0.5f))
                                                       : k_most_erosion;
  }

  Target& target_;
  const DepthImage& image_;
  const ErosionRadius& radius_;
  const int rim_;
};

}  // namespace sightline::raster::SIGHTLINE_LANES
