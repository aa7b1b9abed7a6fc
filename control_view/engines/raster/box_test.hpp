// Included by the kernels only: SIGHTLINE_LANES names the namespace of their instruction set.
#pragma once

#include <cmath>

#include "control_view/engines/raster/target.hpp"

namespace sightline::raster::SIGHTLINE_LANES {

/// Where a box may show in a region: pixels of the region, ends included, and a depth that nothing in it is
/// nearer than.
struct ScreenBox {
  bool visible = false;    ///< may reach into the region at all
  bool unclipped = false;  ///< lies inside the view volume, every edge of it far enough away
  int left = 0, bottom = 0, right = 0, top = 0;
  float nearest = 0.0f;
};

/// A linear map to clip space, [column][row], and the image it leads to.
struct BoxView {
  float clip_from_box[4][4];
  /// What rounding is measured by: the same product with every term's magnitude. Larger than the map's own
  /// entries where large terms cancel, as far from the scene's origin.
  float magnitude[4][4];
  float half_width, half_height;
};

/// Errs towards visible: rounding is bounded by the size of the terms, one pixel is added on every side, and
/// a box that reaches the plane of the eye may show anywhere.
inline ScreenBox screen_box_of(const Aabb& box, const BoxView& view, const Target& target) {
  constexpr int k_corners = 8;
  constexpr float k_rounding = 4e-6f;
  // A pixel centre may lie a few hundredths of a pixel outside the triangle that snapping gave it to, and its
  // depth is extrapolated there: for a surface seen edge-on by any part of the box's own range of depth. So
  // allow as much again as the box is deep, and 1e-3 of the depth (found: 1.2e-4 at most). What goes farther
  // has no thickness in the image: see NeedleIndex.
  constexpr float k_sliver_depth = 1e-3f;
  const float low[3] = {box.min.x, box.min.y, box.min.z};
  const float high[3] = {box.max.x, box.max.y, box.max.z};
  float error[4];
  for (int row = 0; row < 4; ++row) {
    float size = view.magnitude[3][row];
    for (int axis = 0; axis < 3; ++axis) {
      const float a = __builtin_fabsf(low[axis]), b = __builtin_fabsf(high[axis]);
      size += view.magnitude[axis][row] * (a > b ? a : b);
    }
    error[row] = k_rounding * size;
  }

  const Floats error_x = all(error[0]), error_y = all(error[1]), error_z = all(error[2]),
               error_w = all(error[3]);
  const Floats largest_error = max(max(error_x, error_y), error_z) + error_w;
  constexpr unsigned k_every_lane = (1u << k_lanes) - 1u;
  const Floats farthest_out = all(HUGE_VALF);
  Floats low_x = farthest_out, low_y = farthest_out, negative_high_x = farthest_out,
         negative_high_y = farthest_out;
  Floats negative_nearest = farthest_out, farthest = farthest_out;
  unsigned outside[6] = {k_every_lane, k_every_lane, k_every_lane, k_every_lane, k_every_lane, k_every_lane};
  unsigned in_front = k_every_lane;
  unsigned well_inside = k_every_lane;
  const Floats zero = all(0.0f);
  // Lanes beyond the eighth corner repeat the first ones.
  for (int first = 0; first < k_corners; first += k_lanes) {
    const Ints corner = iota() + all(first);
    Floats clip[4];
    for (int row = 0; row < 4; ++row) clip[row] = all(view.clip_from_box[3][row]);
    for (int axis = 0; axis < 3; ++axis) {
      const Mask is_high = (corner & all(1 << axis)) > all(0);
      const Floats coordinate = select(is_high, all(high[axis]), all(low[axis]));
      for (int row = 0; row < 4; ++row)
        clip[row] = clip[row] + all(view.clip_from_box[axis][row]) * coordinate;
    }
    const Floats inside[6] = {clip[3] - clip[0], clip[3] + clip[0], clip[3] - clip[1],
                              clip[3] + clip[1], clip[2],           clip[3] - clip[2]};
    Floats least_inside = inside[0];
    for (int plane = 0; plane < 6; ++plane) {
      outside[plane] &= bits(zero > inside[plane] + largest_error);
      least_inside = min(least_inside, inside[plane]);
    }
    in_front &= bits(clip[3] > error_w);
    well_inside &= bits(least_inside > largest_error);

    const Floats one_over_w = all(1.0f) / (clip[3] - error_w);  // of the corner where it is nearest
    const auto magnitude = [&](Floats a) { return max(a, zero - a); };
    const Floats exact_one_over_w = all(1.0f) / clip[3];
    const Floats x = clip[0] * exact_one_over_w, y = clip[1] * exact_one_over_w,
                 z = clip[2] * exact_one_over_w;
    const Floats slack_x = (error_x + error_w * magnitude(x)) * one_over_w;
    const Floats slack_y = (error_y + error_w * magnitude(y)) * one_over_w;
    const Floats slack_z =
        (error_z + error_w * magnitude(z)) * one_over_w + all(k_sliver_depth) * magnitude(z);
    low_x = min(low_x, x - slack_x);
    low_y = min(low_y, y - slack_y);
    negative_high_x = min(negative_high_x, zero - (x + slack_x));
    negative_high_y = min(negative_high_y, zero - (y + slack_y));
    negative_nearest = min(negative_nearest, zero - (z + slack_z));
    farthest = min(farthest, z);
  }

  ScreenBox result;
  for (const unsigned corners : outside) {
    if (corners == k_every_lane) return result;
  }
  if (in_front != k_every_lane) {
    result.visible = true;
    result.right = target.width - 1;
    result.top = target.height - 1;
    result.nearest = HUGE_VALF;
    return result;
  }
  // In floats first: an int may not hold them.
  const auto to_pixel = [](float ndc, float half) { return (ndc + 1.0f) * half; };
  const auto x0 = static_cast<float>(target.x0), y0 = static_cast<float>(target.y0);
  const float left = to_pixel(least(low_x), view.half_width) - 1.0f - x0;
  const float right = to_pixel(-least(negative_high_x), view.half_width) + 1.0f - x0;
  const float bottom = to_pixel(least(low_y), view.half_height) - 1.0f - y0;
  const float top = to_pixel(-least(negative_high_y), view.half_height) + 1.0f - y0;
  const auto width = static_cast<float>(target.width), height = static_cast<float>(target.height);
  if (right < 0.0f || left >= width || top < 0.0f || bottom >= height) return result;
  result.visible = true;
  result.nearest = -least(negative_nearest);
  const float depth_range = result.nearest - least(farthest);
  if (depth_range > 0.0f) result.nearest += depth_range;
  result.left = left > 0.0f ? static_cast<int>(left) : 0;
  result.bottom = bottom > 0.0f ? static_cast<int>(bottom) : 0;
  result.right = right < width - 1.0f ? static_cast<int>(right) : target.width - 1;
  result.top = top < height - 1.0f ? static_cast<int>(top) : target.height - 1;
  result.unclipped = well_inside == k_every_lane;
  return result;
}

}  // namespace sightline::raster::SIGHTLINE_LANES
