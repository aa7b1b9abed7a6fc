#include "main_view/client/field_coverage.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace sightline {
namespace {

constexpr glm::dvec4 k_no_side{0.0, 0.0, 0.0, 1.0};

/// The inverse of a rigid matrix, without the rounding of a general one.
glm::dmat4 rigid_inverse(const glm::dmat4& rigid) noexcept {
  const glm::dmat3 rotation = glm::transpose(glm::dmat3(rigid));
  glm::dmat4 inverse(rotation);
  inverse[3] = glm::dvec4(-(rotation * glm::dvec3(rigid[3])), 1.0);
  return inverse;
}

/// World box around the part of the hull of `corners` on the outer side of `plane`: the corners that lie
/// there, and the points where the hull's edges cross the plane.
Aabb region_outside(const glm::dvec4& plane, const ViewCorners& corners,
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

ViewCorners view_corners(const Eye& eye) noexcept {
  const glm::dmat4 camera_from_clip = glm::inverse(eye.clip_from_camera);
  ViewCorners corners{};
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

TestedEye::TestedEye(const Eye& requested_eye, double rotation_error_rad) noexcept
    : requested(requested_eye),
      field(frustum_of(widened(requested.clip_from_camera, rotation_error_rad))),
      world_field(tested_field(requested, rotation_error_rad)),
      world_from_requested(rigid_inverse(requested.camera_from_world)) {}

std::vector<CutOff> cut_offs(const Eye& requested, double rotation_error_rad, const Eye& eye) {
  return cut_offs(TestedEye(requested, rotation_error_rad), eye, view_corners(eye));
}

std::vector<CutOff> cut_offs(const TestedEye& tested, const Eye& eye, ViewCorners corners) {
  if (eye == tested.requested) return {};
  const glm::dmat4 requested_from_eye =
      tested.requested.camera_from_world * rigid_inverse(eye.camera_from_world);
  std::array<double, 8> tolerance;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    corners[i] = requested_from_eye * corners[i];
    tolerance[i] = 1e-9 * (1.0 + glm::length(glm::dvec3(corners[i])));
  }

  std::vector<CutOff> cuts;
  for (std::size_t side = 0; side < tested.field.planes.size(); ++side) {
    const glm::dvec4& plane = tested.field.planes[side];
    bool is_cut = false;
    for (std::size_t i = 0; i < corners.size(); ++i)
      is_cut |= !(glm::dot(plane, corners[i]) >= -tolerance[i]);  // NaN cuts
    if (!is_cut) continue;
    CutOff cut;
    cut.inner_side.planes.fill(k_no_side);
    cut.inner_side.planes[side] = tested.world_field.planes[side];
    cut.region = region_outside(plane, corners, tested.world_from_requested);
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
