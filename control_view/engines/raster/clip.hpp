// Included by the kernels only: SIGHTLINE_LANES names the namespace of their instruction set.
#pragma once

#include "control_view/engines/raster/lanes.hpp"

namespace sightline::raster::SIGHTLINE_LANES {

/// A corner in clip space, with its texture coordinates, and where it lies in the window once that is known.
struct ClipVertex {
  float clip[4];
  float u, v;
  float window[3];
};

/// Bit i: outside plane i of clip_distance.
inline constexpr int k_clip_planes = 6;

/// Planes in the order they cut: x <= w, x >= -w, y <= w, y >= -w, z >= 0 (far), z <= w (near).
inline float clip_distance(const ClipVertex& p, int plane) {
  switch (plane) {
    case 0:
      return p.clip[3] - p.clip[0];
    case 1:
      return p.clip[0] + p.clip[3];
    case 2:
      return p.clip[3] - p.clip[1];
    case 3:
      return p.clip[1] + p.clip[3];
    case 4:
      return p.clip[2];
    default:
      return p.clip[3] - p.clip[2];
  }
}

/// The convex polygon that a triangle leaves inside the view volume.
struct ClippedPolygon {
  ClipVertex corners[3 + k_clip_planes];
  int count = 0;
};

inline ClipVertex between(const ClipVertex& out, const ClipVertex& in, float t, float half_width,
                          float half_height) {
  ClipVertex p;
  for (int i = 0; i < 4; ++i) p.clip[i] = out.clip[i] + t * (in.clip[i] - out.clip[i]);
  p.u = out.u + t * (in.u - out.u);
  p.v = out.v + t * (in.v - out.v);
  const float one_over_w = 1.0f / p.clip[3];
  p.window[0] = p.clip[0] * one_over_w * half_width + half_width;
  p.window[1] = p.clip[1] * one_over_w * half_height + half_height;
  p.window[2] = p.clip[2] * one_over_w;
  return p;
}

/// Cuts a triangle by the planes in `planes`; an empty polygon where nothing is left or a distance is not
/// finite.
///
/// Source: Sutherland and Hodgman, "Reentrant Polygon Clipping", 1974. No guard band: OpenGL through llvmpipe
/// cuts at the edges of the view, and a cut corner, snapped anew, moves the edge by up to half a sub-pixel;
/// so equal counts need the same cuts, in the same order and from the outer corner inwards.
inline void clip_triangle(const ClipVertex& a, const ClipVertex& b, const ClipVertex& c, unsigned planes,
                          float half_width, float half_height, ClippedPolygon& polygon) {
  ClippedPolygon other;
  polygon.corners[0] = a;
  polygon.corners[1] = b;
  polygon.corners[2] = c;
  polygon.count = 3;
  ClippedPolygon* from = &polygon;
  ClippedPolygon* to = &other;
  for (int plane = 0; plane < k_clip_planes; ++plane) {
    if ((planes >> plane & 1u) == 0 || from->count < 3) continue;
    to->count = 0;
    const ClipVertex* previous = &from->corners[0];
    float previous_distance = clip_distance(*previous, plane);
    bool finite = __builtin_isfinite(previous_distance);
    for (int i = 1; i <= from->count && finite; ++i) {
      const ClipVertex* const current = &from->corners[i == from->count ? 0 : i];
      const float distance = clip_distance(*current, plane);
      if (!__builtin_isfinite(distance)) {
        finite = false;
        break;
      }
      if (previous_distance >= 0.0f) to->corners[to->count++] = *previous;
      if ((previous_distance >= 0.0f) != (distance >= 0.0f)) {
        // From the outside corner, and the parameter of the corner that lies nearer to the plane.
        const float span = distance - previous_distance;
        const bool leaving = distance < 0.0f;
        const bool current_nearer =
            leaving ? -distance < previous_distance : !(-previous_distance < distance);
        const float t = current_nearer ? distance / span : -previous_distance / span;
        to->corners[to->count++] = current_nearer ? between(*current, *previous, t, half_width, half_height)
                                                  : between(*previous, *current, t, half_width, half_height);
      }
      previous = current;
      previous_distance = distance;
    }
    if (!finite) to->count = 0;
    ClippedPolygon* const swapped = from;
    from = to;
    to = swapped;
  }
  if (from != &polygon) polygon = *from;
  if (polygon.count < 3) polygon.count = 0;
}

}  // namespace sightline::raster::SIGHTLINE_LANES
