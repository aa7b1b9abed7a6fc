// Included by the kernels only: SIGHTLINE_LANES names the namespace of their instruction set.
#pragma once

#include <cmath>

#include "control_view/engines/raster/kernel.hpp"
#include "control_view/engines/raster/lanes.hpp"

namespace sightline::raster::SIGHTLINE_LANES {

/// Which needles of one vector may own a pixel with a depth gone astray: see FindNeedles.
inline unsigned needles_among(const NeedleView& view, const NeedleGroup& group, int first) {
  const Floats half_width = all(0.5f * static_cast<float>(view.image.image_width));
  const Floats half_height = all(0.5f * static_cast<float>(view.image.image_height));
  const auto row_of = [&](int row, const Floats p[3]) {
    const float(&m)[4][4] = view.image.clip_from_scene;
    return all(m[0][row]) * p[0] + all(m[1][row]) * p[1] + all(m[2][row]) * p[2] + all(m[3][row]);
  };
  const Floats zero = all(0.0f);
  Floats x[3], y[3];
  Floats nearest_w = all(HUGE_VALF), farthest_w = zero, least_inside = all(HUGE_VALF);
  for (int corner = 0; corner < 3; ++corner) {
    const Floats p[3] = {load(group.x[corner] + first), load(group.y[corner] + first),
                         load(group.z[corner] + first)};
    // To the bit where OpenGL has them, as in transform().
    const Floats clip_x = row_of(0, p), clip_y = row_of(1, p), clip_z = row_of(2, p), w = row_of(3, p);
    const Floats one_over_w = all(1.0f) / w;
    x[corner] = fused_multiply_add(clip_x * one_over_w, half_width, half_width);
    y[corner] = fused_multiply_add(clip_y * one_over_w, half_height, half_height);
    nearest_w = min(w, nearest_w);
    farthest_w = max(w, farthest_w);
    for (const Floats inside : {w - clip_x, clip_x + w, w - clip_y, clip_y + w, clip_z, w - clip_z}) {
      least_inside = min(inside, least_inside);
    }
  }
  // What reaches behind the eye has no place in the image.
  const Mask before_eye = nearest_w > all(view.noise_w);
  const Mask around_eye = (!before_eye) & (farthest_w > zero);

  const Floats noise = all(view.noise_px) + all(view.noise_px_w) / max(nearest_w, all(view.noise_w));
  const Floats reach = noise + all(k_needle_snap_px);
  const auto low = [](const Floats a[3]) { return min(min(a[0], a[1]), a[2]); };
  const auto high = [](const Floats a[3]) { return max(max(a[0], a[1]), a[2]); };
  const auto holds_a_centre = [&](Floats from, Floats to, int begin, int end) {
    // Pixel i has its centre at i + 0.5.
    from = max(from - reach, all(static_cast<float>(begin)));
    to = min(to + reach, all(static_cast<float>(end)));
    return !(round_to_int(from) > round_to_int(to - all(1.0f)));
  };
  const RasterRegion& part = view.part;
  const Floats left = low(x), right = high(x), bottom = low(y), top = high(y);
  const Mask centred = holds_a_centre(left, right, part.x, part.x + part.width) &
                       holds_a_centre(bottom, top, part.y, part.y + part.height);

  const Floats area = (x[0] - x[2]) * (y[1] - y[2]) - (y[0] - y[2]) * (x[1] - x[2]);
  const Floats length = max(right - left, top - bottom);
  const Floats magnitude = max(area, zero - area);
  // A corner beyond the view is replaced by others on the same line, which round anew.
  const Floats thin = select(least_inside > zero, noise * all(k_needle_astray), noise * all(k_needle_sure));
  // Which corner the area is reckoned from makes a difference of rounding.
  const Floats limit = (thin + all(4e-7f) * length) * (length + noise);
  const Mask astray = !(magnitude > limit);
  return bits((before_eye & centred & astray) | around_eye);
}

inline unsigned find_needles(const NeedleView& view, const NeedleGroup& group) {
  unsigned found = 0;
  for (int first = 0; first < static_cast<int>(k_padding); first += k_lanes) {
    found |= (needles_among(view, group, first) & ((1u << k_lanes) - 1u)) << first;
  }
  return found;
}

}  // namespace sightline::raster::SIGHTLINE_LANES
