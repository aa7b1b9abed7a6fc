#include "tests/control_view/plain_raster_triangle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

// Compiled without contraction: where a step below is fused it says std::fma, everywhere else llvmpipe rounds
// each product and each sum, and so must this file.

namespace sightline::test {
namespace {

/// llvmpipe hands a draw to its clipper in runs of at most 1024 indices, whole triangles.
constexpr std::size_t k_segment_corners = 1023;
constexpr int k_plane_count = 6;
constexpr std::int64_t k_sub_pixels = 256;

/// Rows of matrix times vector, summed from the first column to the last.
glm::vec4 transformed(const glm::mat4& matrix, const glm::vec4& vector) {
  glm::vec4 result;
  for (int row = 0; row < 4; ++row) {
    result[row] = ((matrix[0][row] * vector.x + matrix[1][row] * vector.y) + matrix[2][row] * vector.z) +
                  matrix[3][row] * vector.w;
  }
  return result;
}

/// Signed distance, in clip space, inwards: right, left, top, bottom, far (depth 0), near (depth w).
float inside_distance(const glm::vec4& clip, int plane) {
  switch (plane) {
    case 0:
      return -clip.x + clip.w;
    case 1:
      return clip.x + clip.w;
    case 2:
      return -clip.y + clip.w;
    case 3:
      return clip.y + clip.w;
    case 4:
      return clip.z;
    default:
      return -clip.z + clip.w;
  }
}

std::uint32_t planes_violated(const glm::vec4& clip) {
  std::uint32_t outside = 0;
  for (int plane = 0; plane < k_plane_count; ++plane) {
    // Written so that NaN counts as outside: the clipper then drops the triangle.
    if (!(inside_distance(clip, plane) >= 0.0f)) outside |= 1u << plane;
  }
  return outside;
}

/// A vertex made by the clipper. Its window position is computed by C code, which does not fuse.
PlainVertex between(const PlainVertex& from, const PlainVertex& to, float t, ImageSize size) {
  PlainVertex made;
  for (int i = 0; i < 4; ++i) made.clip[i] = from.clip[i] + t * (to.clip[i] - from.clip[i]);
  for (int i = 0; i < 2; ++i) made.uv[i] = from.uv[i] + t * (to.uv[i] - from.uv[i]);
  made.reciprocal_w = 1.0f / made.clip.w;
  const float half_width = 0.5f * static_cast<float>(size.width);
  const float half_height = 0.5f * static_cast<float>(size.height);
  made.window.x = made.clip.x * made.reciprocal_w * half_width + half_width;
  made.window.y = made.clip.y * made.reciprocal_w * half_height + half_height;
  made.window.z = made.clip.z * made.reciprocal_w;
  return made;
}

/// The point where the edge `a` to `b` crosses a plane, interpolated from the end nearer to it.
PlainVertex crossing(const PlainVertex& a, float distance_a, const PlainVertex& b, float distance_b,
                     ImageSize size) {
  const float span = distance_b - distance_a;
  const bool leaving = distance_b < 0.0f;
  const bool nearer_to_b = leaving ? -distance_b < distance_a : !(-distance_a < distance_b);
  return nearer_to_b ? between(b, a, distance_b / span, size) : between(a, b, -distance_a / span, size);
}

/// One step of Sutherland and Hodgman, "Reentrant Polygon Clipping", 1974. Empty when a distance is not
/// finite.
std::vector<PlainVertex> clipped_by(const std::vector<PlainVertex>& polygon, int plane, ImageSize size) {
  std::vector<PlainVertex> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const PlainVertex& here = polygon[i];
    const PlainVertex& next = polygon[(i + 1) % polygon.size()];
    const float distance_here = inside_distance(here.clip, plane);
    const float distance_next = inside_distance(next.clip, plane);
    if (!std::isfinite(distance_here) || !std::isfinite(distance_next)) return {};
    if (distance_here >= 0.0f) kept.push_back(here);
    if ((distance_here >= 0.0f) != (distance_next >= 0.0f)) {
      kept.push_back(crossing(here, distance_here, next, distance_next, size));
    }
  }
  return kept;
}

/// The clipper's own back-face test, on float positions. Differs from the rasterizer's only for triangles
/// thinner than a sub-pixel.
bool clipper_culls(const PlainVertex& v0, const PlainVertex& v1, const PlainVertex& v2, PlainFaces faces) {
  if (faces.double_sided) return false;
  const float ex = v0.window.x - v2.window.x, ey = v0.window.y - v2.window.y;
  const float fx = v1.window.x - v2.window.x, fy = v1.window.y - v2.window.y;
  const float twice_area = ex * fy - ey * fx;
  return faces.mirrored ? !(twice_area < 0.0f) : !(twice_area > 0.0f);
}

/// Position in 1/256 pixels, such that pixel centres are at multiples of 256. Rounds to nearest, ties to
/// even.
std::int64_t snapped(float window) {
  const float scaled = (window - 0.5f) * static_cast<float>(k_sub_pixels);
  const bool representable = std::abs(scaled) < 2147483648.0f;
  return representable ? std::llrint(scaled) : std::numeric_limits<std::int32_t>::min();
}

/// A value that is linear over the image: at pixel (x, y) it is base + x * dx + y * dy.
struct Plane {
  float base = 0.0f, dx = 0.0f, dy = 0.0f;

  [[nodiscard]] float at(std::int64_t x, std::int64_t y) const {
    return std::fma(dy, static_cast<float>(y), std::fma(dx, static_cast<float>(x), base));
  }
};

/// Planes through values at the corners, from the positions as they were before snapping.
class PlaneSetup {
 public:
  PlaneSetup(const glm::vec3& p0, const glm::vec3& p1, const glm::vec3& p2) {
    const float dx01 = p0.x - p1.x, dy01 = p0.y - p1.y;
    const float dx20 = p2.x - p0.x, dy20 = p2.y - p0.y;
    const float reciprocal_area = 1.0f / (dx01 * dy20 - dy01 * dx20);
    dx01_ = dx01 * reciprocal_area;
    dy01_ = dy01 * reciprocal_area;
    dx20_ = dx20 * reciprocal_area;
    dy20_ = dy20 * reciprocal_area;
    centre_x_ = p0.x - 0.5f;
    centre_y_ = p0.y - 0.5f;
  }

  [[nodiscard]] Plane through(float value0, float value1, float value2) const {
    const float difference01 = value0 - value1, difference20 = value2 - value0;
    Plane plane;
    plane.dx = difference01 * dy20_ - difference20 * dy01_;
    plane.dy = difference20 * dx01_ - difference01 * dx20_;
    plane.base = value0 - (plane.dx * centre_x_ + plane.dy * centre_y_);
    return plane;
  }

 private:
  float dx01_, dy01_, dx20_, dy20_, centre_x_, centre_y_;
};

/// The edge from `a` to `b` of a triangle that turns with positive area: positive inside. A pixel centre on
/// the edge belongs to the triangle when the edge is a left or a lower one, y up.
struct Edge {
  std::int64_t ax, ay, dx, dy;
  std::int64_t on_edge_bonus;

  Edge(std::int64_t from_x, std::int64_t from_y, std::int64_t to_x, std::int64_t to_y)
      : ax(from_x), ay(from_y), dx(from_x - to_x), dy(from_y - to_y) {
    const bool owns_its_pixels = dy < 0 || (dy == 0 && dx > 0);
    on_edge_bonus = owns_its_pixels ? 1 : 0;
  }

  [[nodiscard]] bool covers(std::int64_t x, std::int64_t y) const {
    return dy * (ax - x * k_sub_pixels) - dx * (ay - y * k_sub_pixels) + on_edge_bonus > 0;
  }
};

/// Depth is capped at the near plane, and so is what is not a number: a triangle without area in floats that
/// gained some by snapping comes out in front of everything.
float clamped(float depth) {
  return depth < 1.0f ? depth : 1.0f;
}

void rasterize(const PlainVertex* v0, const PlainVertex* v1, const PlainVertex* v2, PlainFaces faces,
               ImageSize size, const FragmentVisitor& visit) {
  std::array<std::int64_t, 3> x = {snapped(v0->window.x), snapped(v1->window.x), snapped(v2->window.x)};
  std::array<std::int64_t, 3> y = {snapped(v0->window.y), snapped(v1->window.y), snapped(v2->window.y)};
  const std::int64_t area = (x[0] - x[1]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[0] - y[1]);
  const bool counter_clockwise = area < 0;
  if (area == 0 || (!faces.double_sided && counter_clockwise == faces.mirrored)) return;
  if (counter_clockwise) {
    // Turned by swapping the first two: it decides which corner the planes start from.
    std::swap(v0, v1);
    std::swap(x[0], x[1]);
    std::swap(y[0], y[1]);
  }

  const PlaneSetup setup(v0->window, v1->window, v2->window);
  const Plane depth = setup.through(v0->window.z, v1->window.z, v2->window.z);
  const float r0 = v0->reciprocal_w, r1 = v1->reciprocal_w, r2 = v2->reciprocal_w;
  const Plane reciprocal_w = setup.through(r0, r1, r2);
  const Plane u = setup.through(v0->uv.x * r0, v1->uv.x * r1, v2->uv.x * r2);
  const Plane v = setup.through(v0->uv.y * r0, v1->uv.y * r1, v2->uv.y * r2);

  const std::array<Edge, 3> edges = {Edge(x[0], y[0], x[1], y[1]), Edge(x[1], y[1], x[2], y[2]),
                                     Edge(x[2], y[2], x[0], y[0])};
  const auto [left, right] = std::minmax({x[0], x[1], x[2]});
  const auto [bottom, top] = std::minmax({y[0], y[1], y[2]});
  const std::int64_t last_x = std::min<std::int64_t>(right / k_sub_pixels, size.width - 1);
  const std::int64_t last_y = std::min<std::int64_t>(top / k_sub_pixels, size.height - 1);
  for (std::int64_t py = std::max<std::int64_t>(bottom / k_sub_pixels, 0); py <= last_y; ++py) {
    for (std::int64_t px = std::max<std::int64_t>(left / k_sub_pixels, 0); px <= last_x; ++px) {
      if (!edges[0].covers(px, py) || !edges[1].covers(px, py) || !edges[2].covers(px, py)) continue;
      const float w = 1.0f / reciprocal_w.at(px, py);
      visit({static_cast<std::size_t>(py) * size.width + static_cast<std::size_t>(px),
             clamped(depth.at(px, py)), glm::vec2(u.at(px, py) * w, v.at(px, py) * w)});
    }
  }
}

void clip_and_rasterize(const PlainVertex* corners, PlainFaces faces, ImageSize size,
                        const FragmentVisitor& visit) {
  const std::uint32_t any = corners[0].outside | corners[1].outside | corners[2].outside;
  const std::uint32_t all = corners[0].outside & corners[1].outside & corners[2].outside;
  if (all != 0) return;
  if (any == 0) {
    if (!clipper_culls(corners[0], corners[1], corners[2], faces)) {
      rasterize(&corners[0], &corners[1], &corners[2], faces, size, visit);
    }
    return;
  }
  std::vector<PlainVertex> polygon(corners, corners + 3);
  for (int plane = 0; plane < k_plane_count; ++plane) {
    if ((any & (1u << plane)) != 0) polygon = clipped_by(polygon, plane, size);
    if (polygon.size() < 3) return;
  }
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    if (clipper_culls(polygon[i - 1], polygon[i], polygon[0], faces)) continue;
    rasterize(&polygon[i - 1], &polygon[i], &polygon[0], faces, size, visit);
  }
}

}  // namespace

PlainVertex plain_vertex(const glm::mat4& clip_from_scene, const glm::mat4& scene_from_object,
                         const glm::vec3& position, const glm::vec2& uv, ImageSize size) {
  PlainVertex vertex;
  vertex.clip = transformed(clip_from_scene, transformed(scene_from_object, glm::vec4(position, 1.0f)));
  vertex.outside = planes_violated(vertex.clip);
  vertex.reciprocal_w = 1.0f / vertex.clip.w;
  const float half_width = 0.5f * static_cast<float>(size.width);
  const float half_height = 0.5f * static_cast<float>(size.height);
  vertex.window.x = std::fma(vertex.clip.x * vertex.reciprocal_w, half_width, half_width);
  vertex.window.y = std::fma(vertex.clip.y * vertex.reciprocal_w, half_height, half_height);
  vertex.window.z = vertex.clip.z * vertex.reciprocal_w;
  vertex.uv = uv;
  return vertex;
}

void draw_triangles(std::span<const PlainVertex> corners, PlainFaces faces, ImageSize size,
                    const FragmentVisitor& visit) {
  for (std::size_t first = 0; first < corners.size(); first += k_segment_corners) {
    const auto segment = corners.subspan(first, std::min(k_segment_corners, corners.size() - first));
    const bool any_clipped =
        std::any_of(segment.begin(), segment.end(), [](const PlainVertex& v) { return v.outside != 0; });
    for (std::size_t i = 0; i + 2 < segment.size(); i += 3) {
      if (any_clipped) {
        clip_and_rasterize(&segment[i], faces, size, visit);
      } else {
        rasterize(&segment[i], &segment[i + 1], &segment[i + 2], faces, size, visit);
      }
    }
  }
}

}  // namespace sightline::test
