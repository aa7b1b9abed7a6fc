#include "main_view/client/field_coverage.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace sightline {
namespace {

constexpr glm::dvec4 k_no_side{0.0, 0.0, 0.0, 1.0};

/// Homogeneous corners of a projection's frustum, camera frame; w is 1, or 0 for a direction. NaN where it
/// has none.
std::array<glm::dvec4, 8> corners_of(const glm::dmat4& clip_from_camera) noexcept {
  const glm::dmat4 camera_from_clip = glm::inverse(clip_from_camera);
  std::array<glm::dvec4, 8> corners{};
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

}  // namespace

Frustum tested_field(const Eye& requested, double rotation_error_rad) noexcept {
  return frustum_of(widened(requested.clip_from_camera, rotation_error_rad) * requested.camera_from_world);
}

Frustum cutting_sides(const Eye& requested, double rotation_error_rad, const Eye& eye) noexcept {
  Frustum sides = tested_field(requested, rotation_error_rad);
  if (eye == requested) {
    sides.planes.fill(k_no_side);
    return sides;
  }
  // Compared in the requesting camera's frame: far from the origin the world frame has no digits left for
  // this.
  const Frustum field = frustum_of(widened(requested.clip_from_camera, rotation_error_rad));
  const glm::dmat4 requested_from_eye = requested.camera_from_world * rigid_inverse(eye.camera_from_world);
  std::array<glm::dvec4, 8> corners = corners_of(eye.clip_from_camera);
  for (glm::dvec4& corner : corners) corner = requested_from_eye * corner;
  for (std::size_t side = 0; side < sides.planes.size(); ++side) {
    const bool cuts = std::any_of(corners.begin(), corners.end(), [&](const glm::dvec4& corner) {
      const double tolerance = 1e-9 * (1.0 + glm::length(glm::dvec3(corner)));
      return !(glm::dot(field.planes[side], corner) >= -tolerance);  // NaN cuts
    });
    if (!cuts) sides.planes[side] = k_no_side;
  }
  return sides;
}

bool cuts_nothing(const Frustum& cutting) noexcept {
  return std::all_of(cutting.planes.begin(), cutting.planes.end(),
                     [](const glm::dvec4& plane) { return plane == k_no_side; });
}

}  // namespace sightline
