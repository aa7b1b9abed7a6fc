#include "main_view/client/field_coverage.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace sightline {
namespace {

constexpr glm::dvec4 k_no_side{0.0, 0.0, 0.0, 1.0};

using Corners = std::array<glm::dvec4, 8>;

/// Homogeneous corners of a projection's frustum, camera frame; w is 1, or 0 for a direction. NaN where it
/// has none.
Corners corners_of(const glm::dmat4& clip_from_camera) noexcept {
  const glm::dmat4 camera_from_clip = glm::inverse(clip_from_camera);
  Corners corners{};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec4 clip((i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 1.0 : -1.0, (i & 4) != 0 ? 1.0 : -1.0,
                          1.0);
    const glm::dvec4 corner = camera_from_clip * clip;
    const double reach = glm::length(glm::dvec3(corner));
    if (std::abs(corner.w) > 1e-9 * reach) {
      // A corner beyond infinity (w < 0) has no place in a convex hull.
      corners[i] = corner.w > 0.0 ? corner / corner.w : glm::dvec4(std::nan(""));
    } else {
      corners[i] = glm::dvec4(glm::dvec3(corner) / reach, 0.0);
    }
  }
  return corners;
}

/// The inverse of a rigid matrix, without the rounding of a general one.
glm::dmat4 rigid_inverse(const glm::dmat4& rigid) noexcept {
  const glm::dmat3 rotation = glm::transpose(glm::dmat3(rigid));
  glm::dmat4 inverse(rotation);
  inverse[3] = glm::dvec4(-(rotation * glm::dvec3(rigid[3])), 1.0);
  return inverse;
}

/// World box around the part of the hull of `corners` on the outer side of `plane`: the corners that lie
/// there, and the points where the hull's edges cross the plane.
Aabb region_outside(const glm::dvec4& plane, const Corners& corners,
                    const glm::dmat4& world_from_corners) noexcept {
  constexpr float k_infinity = std::numeric_limits<float>::infinity();
  constexpr Aabb k_everywhere{glm::vec3(-k_infinity), glm::vec3(k_infinity)};
  Aabb region;
  bool bounded = true;
  const auto add = [&](const glm::dvec4& vertex) {
    const glm::dvec3 point(world_from_corners * (vertex / vertex.w));
    const double reach = std::max({std::abs(point.x), std::abs(point.y), std::abs(point.z)});
    const double rounding = 1e-6 * (1.0 + reach);
    bounded = bounded && vertex.w > 0.0 && std::isfinite(rounding);
    region.add(glm::vec3(point - rounding));
    region.add(glm::vec3(point + rounding));
  };
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const double here = glm::dot(plane, corners[i]);
    if (!(here > 0.0)) add(corners[i]);
    for (const std::size_t bit : {1u, 2u, 4u}) {  // the edges to the corners above it
      if ((i & bit) != 0) continue;
      const double there = glm::dot(plane, corners[i | bit]);
      if ((here < 0.0) != (there < 0.0))
        add(corners[i] * std::abs(there) + corners[i | bit] * std::abs(here));
    }
  }
  return bounded ? region : k_everywhere;
}

}  // namespace

Frustum tested_field(const Eye& requested, double rotation_error_rad) noexcept {
  return frustum_of(widened(requested.clip_from_camera, rotation_error_rad) * requested.camera_from_world);
}

std::vector<CutOff> cut_offs(const Eye& requested, double rotation_error_rad, const Eye& eye) {
  if (eye == requested) return {};
  // Compared in the requesting camera's frame: far from the origin the world frame has no digits left for
  // this.
  const Frustum field = frustum_of(widened(requested.clip_from_camera, rotation_error_rad));
  const Frustum world_field = tested_field(requested, rotation_error_rad);
  const glm::dmat4 world_from_requested = rigid_inverse(requested.camera_from_world);
  const glm::dmat4 requested_from_eye = requested.camera_from_world * rigid_inverse(eye.camera_from_world);
  Corners corners = corners_of(eye.clip_from_camera);
  for (glm::dvec4& corner : corners) corner = requested_from_eye * corner;

  std::vector<CutOff> cuts;
  for (std::size_t side = 0; side < field.planes.size(); ++side) {
    const glm::dvec4& plane = field.planes[side];
    const bool is_cut = std::any_of(corners.begin(), corners.end(), [&](const glm::dvec4& corner) {
      const double tolerance = 1e-9 * (1.0 + glm::length(glm::dvec3(corner)));
      return !(glm::dot(plane, corner) >= -tolerance);  // NaN cuts
    });
    if (!is_cut) continue;
    CutOff cut;
    cut.inner_side.planes.fill(k_no_side);
    cut.inner_side.planes[side] = world_field.planes[side];
    cut.region = region_outside(plane, corners, world_from_requested);
    cuts.push_back(cut);
  }
  return cuts;
}

bool CutOff::may_hold(const Aabb& box) const noexcept {
  if (definitely_contains(inner_side, box)) return false;
  const bool apart = box.max.x < region.min.x || box.min.x > region.max.x || box.max.y < region.min.y ||
                     box.min.y > region.max.y || box.max.z < region.min.z || box.min.z > region.max.z;
  return !apart;  // NaN is not apart
}

}  // namespace sightline
