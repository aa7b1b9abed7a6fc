// Included by the kernels only: SIGHTLINE_LANES names the namespace of their instruction set.
#pragma once

#include "control_view/engines/raster/fill.hpp"

namespace sightline::raster::SIGHTLINE_LANES {

/// One vector of triangles in window coordinates: pixels from the lower left of the whole image, depth 1 near
/// .. 0 far. By corner, then lane.
struct Batch {
  float x[3][k_lanes];
  float y[3][k_lanes];
  float depth[3][k_lanes];
  // Masked items only: texture coordinates divided by w, and 1 / w.
  float u[3][k_lanes];
  float v[3][k_lanes];
  float one_over_w[3][k_lanes];
  int count = 0;
};

/// Sub-pixels of a pixel.
inline constexpr float k_subpixels = 256.0f;

/// Whether llvmpipe's clipping pipeline, which all triangles of a primitive run through once any of its
/// vertices is outside the view, keeps a triangle: its own look at the winding is in single precision and
/// before snapping.
inline bool winding_survives_clipping(const Batch& b, int lane, bool mirrored) {
  const float ex = b.x[0][lane] - b.x[2][lane], ey = b.y[0][lane] - b.y[2][lane];
  const float fx = b.x[1][lane] - b.x[2][lane], fy = b.y[1][lane] - b.y[2][lane];
  const float area = ex * fy - ey * fx;
  return mirrored ? area < 0.0f : area > 0.0f;
}

/// Snaps the triangles, drops those that face away or own no pixel of the region, and hands the others on:
/// draw(triangle, lane, counter_clockwise).
///
/// Source: Pineda, "A Parallel Algorithm for Polygon Rasterization", 1988. The arithmetic is llvmpipe's, step
/// by step: eight bits of sub-pixels, pixel centres on whole positions, left and lower edges inclusive,
/// winding by the snapped area, the depth plane through the unsnapped corners with its first corner as the
/// reference.
///
/// `grown`: triangles as large as the pixels they touch, and nowhere nearer than their nearest corner. A
/// pixel at a sharp corner may be taken that the triangle does not touch.
template <bool grown = false, class Draw>
inline void set_up(const Target& target, const Batch& batch, bool double_sided, bool mirrored, Draw&& draw) {
  const Floats half = all(0.5f), subpixels = all(k_subpixels);
  Floats fx[3], fy[3], fz[3];
  Ints x[3], y[3];
  for (int c = 0; c < 3; ++c) {
    fx[c] = load(batch.x[c]);
    fy[c] = load(batch.y[c]);
    fz[c] = load(batch.depth[c]);
    x[c] = round_to_int((fx[c] - half) * subpixels);
    y[c] = round_to_int((fy[c] - half) * subpixels);
  }
  // The first pixel centre at or after a position, the last at or before it; of pixels touched, half a pixel
  // farther out.
  constexpr std::int32_t k_reach = grown ? 128 : 0;
  const Ints left = shift_right<8>(min(min(x[0], x[1]), x[2]) + all(255 - k_reach));
  const Ints right = shift_right<8>(max(max(x[0], x[1]), x[2]) + all(k_reach));
  const Ints bottom = shift_right<8>(min(min(y[0], y[1]), y[2]) + all(255 - k_reach));
  const Ints top = shift_right<8>(max(max(y[0], y[1]), y[2]) + all(k_reach));
  const Ints region_left = all(target.x0), region_right = all(target.x0 + target.width - 1);
  const Ints region_bottom = all(target.y0), region_top = all(target.y0 + target.height - 1);
  // A corner that is not finite, or stands for none.
  const Ints farthest = all(1 << 16);
  const Mask odd = (right > farthest) | (top > farthest) | (all(-16) > left) | (all(-16) > bottom);
  const Mask missed = odd | (left > right) | (bottom > top) | (left > region_right) | (region_left > right) |
                      (bottom > region_top) | (region_bottom > top);
  unsigned remaining = bits(!missed) & ((1u << batch.count) - 1u);
  if (remaining == 0) return;

  // Winding by the snapped area. In floats its sign is sure where it is large beside its terms.
  const Floats ax = to_float(x[1] - x[0]), ay = to_float(y[1] - y[0]);
  const Floats bx = to_float(x[2] - x[0]), by = to_float(y[2] - y[0]);
  const Floats plus = ax * by, minus = ay * bx;
  const Floats area = plus - minus;
  const auto magnitude = [](Floats a) { return max(a, all(0.0f) - a); };
  const unsigned sure = bits(magnitude(area) > all(5e-7f) * (magnitude(plus) + magnitude(minus)));
  unsigned counter_clockwise = bits(area > all(0.0f)) & sure;
  if (!double_sided) remaining &= (mirrored ? ~counter_clockwise : counter_clockwise) | ~sure;
  if (remaining == 0) return;

  std::int32_t ix[3][k_lanes], iy[3][k_lanes];
  for (int c = 0; c < 3; ++c) {
    store(ix[c], x[c]);
    store(iy[c], y[c]);
  }
  for (unsigned rest = remaining & ~sure; rest != 0; rest &= rest - 1) {
    const int lane = __builtin_ctz(rest);
    const std::int64_t exact = std::int64_t{ix[1][lane] - ix[0][lane]} * (iy[2][lane] - iy[0][lane]) -
                               std::int64_t{iy[1][lane] - iy[0][lane]} * (ix[2][lane] - ix[0][lane]);
    if (exact > 0) counter_clockwise |= 1u << lane;
    const bool front = (exact > 0) != mirrored;
    if (exact == 0 || !(double_sided || front)) remaining &= ~(1u << lane);
  }
  if (remaining == 0) return;

  // Counter-clockwise triangles are taken as corners 1, 0, 2.
  std::int32_t turned_lanes[k_lanes];
  for (int i = 0; i < k_lanes; ++i) turned_lanes[i] = (counter_clockwise >> i & 1u) != 0 ? 1 : 0;
  const Mask turned = load(turned_lanes) > all(0);
  const Floats x0 = select(turned, fx[1], fx[0]), x1 = select(turned, fx[0], fx[1]), x2 = fx[2];
  const Floats y0 = select(turned, fy[1], fy[0]), y1 = select(turned, fy[0], fy[1]), y2 = fy[2];
  const Floats z0 = select(turned, fz[1], fz[0]), z1 = select(turned, fz[0], fz[1]), z2 = fz[2];
  Floats dx01 = x0 - x1, dy01 = y0 - y1, dx20 = x2 - x0, dy20 = y2 - y0;
  const Floats one_over_area = all(1.0f) / (dx01 * dy20 - dy01 * dx20);
  dx01 = dx01 * one_over_area;
  dy01 = dy01 * one_over_area;
  dx20 = dx20 * one_over_area;
  dy20 = dy20 * one_over_area;
  const Floats z01 = z0 - z1, z20 = z2 - z0;
  const Floats depth_x = z01 * dy20 - z20 * dy01;
  const Floats depth_y = z20 * dx01 - z01 * dx20;
  Floats depth_0 = z0 - (depth_x * (x0 - half) + depth_y * (y0 - half));
  if constexpr (grown) depth_0 = depth_0 + half * (magnitude(depth_x) + magnitude(depth_y));

  float plane_x[k_lanes], plane_y[k_lanes], plane_0[k_lanes];
  store(plane_x, depth_x);
  store(plane_y, depth_y);
  store(plane_0, depth_0);
  float nearest[k_lanes];
  if constexpr (grown) store(nearest, max(max(z0, z1), z2));
  std::int32_t lefts[k_lanes], rights[k_lanes], bottoms[k_lanes], tops[k_lanes];
  store(lefts, max(left, region_left));
  store(rights, min(right, region_right));
  store(bottoms, max(bottom, region_bottom));
  store(tops, min(top, region_top));

  for (; remaining != 0; remaining &= remaining - 1) {
    const int lane = __builtin_ctz(remaining);
    const bool ccw = (counter_clockwise >> lane & 1u) != 0;
    FillTriangle t;
    // Counter-clockwise, whatever it was: the inside lies to the left of every edge.
    const int order[3] = {ccw ? 0 : 1, ccw ? 1 : 0, 2};
    for (int i = 0; i < 3; ++i) {
      const int from = order[i], to = order[i == 2 ? 0 : i + 1];
      const std::int32_t dx = ix[to][lane] - ix[from][lane];
      const std::int32_t dy = iy[to][lane] - iy[from][lane];
      t.step_x[i] = -dy;
      t.step_y[i] = dx;
      const std::int64_t at = std::int64_t{dy} * ix[from][lane] - std::int64_t{dx} * iy[from][lane];
      const bool inclusive = dy < 0 || (dy == 0 && dx > 0);
      t.at_origin[i] = (inclusive ? at : at - 1) >> 8;
      if constexpr (grown) t.at_origin[i] += (dx < 0 ? -dx : dx) / 2 + (dy < 0 ? -dy : dy) / 2 + 1;
    }
    t.depth_most = grown ? nearest[lane] : 1.0f;
    t.depth_x = plane_x[lane];
    t.depth_y = plane_y[lane];
    t.depth_0 = plane_0[lane];
    t.left = lefts[lane];
    t.right = rights[lane];
    t.bottom = bottoms[lane];
    t.top = tops[lane];
    draw(t, lane, ccw);
  }
}

}  // namespace sightline::raster::SIGHTLINE_LANES
