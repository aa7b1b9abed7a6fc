#include "main_view/client/occluder_shadow.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace sightline {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();
/// A flat box is thickened by this, relative to its size and distance, so that it has an inside.
constexpr double k_thickness = 1e-9;

enum class RaySort { from_a_point, parallel, other };

RaySort ray_sort_of(const glm::dmat4& clip_from_camera) noexcept {
  const auto w = [&](int column) { return clip_from_camera[column][3]; };
  if (w(0) != 0.0 || w(1) != 0.0) return RaySort::other;
  if (w(2) != 0.0 && w(3) == 0.0) return RaySort::from_a_point;
  if (w(2) == 0.0 && w(3) != 0.0) return RaySort::parallel;
  return RaySort::other;
}

/// Of parallel rays: the direction towards the eye, camera frame, along which x and y of clip space stay.
glm::dvec3 towards_eye_of(const glm::dmat4& clip_from_camera) noexcept {
  const auto row = [&](int i) {
    return glm::dvec3(clip_from_camera[0][i], clip_from_camera[1][i], clip_from_camera[2][i]);
  };
  const glm::dvec3 along = glm::cross(row(0), row(1));
  const bool away = glm::dot(row(2), along) * clip_from_camera[3][3] > 0.0;  // depth grows away from the eye
  return glm::normalize(away ? -along : along);
}

}  // namespace

bool OccluderShadow::depends_on_place_alone(const Eye& eye) noexcept {
  return ray_sort_of(eye.clip_from_camera) == RaySort::from_a_point;
}

OccluderShadow::OccluderShadow(const Eye& eye, const WorldBox& box, double slack_m) noexcept
    : slack_m_(slack_m), low_(-k_infinity), high_(k_infinity) {
  const glm::dmat3 world_from_camera = glm::transpose(glm::dmat3(eye.camera_from_world));
  const RaySort sort = ray_sort_of(eye.clip_from_camera);
  const glm::dvec3 eye_m = -(world_from_camera * glm::dvec3(eye.camera_from_world[3]));
  origin_m_ = sort == RaySort::parallel ? 0.5 * (box.min + box.max) : eye_m;

  // From eye + d, a point p is behind the box where from the eye p - d is behind the box moved by -d: so both
  // box and object grow by the slack, each to its own side.
  WorldBox near{box.min - origin_m_, box.max - origin_m_};
  const glm::dvec3 reach = glm::max(glm::abs(near.min), glm::abs(near.max));
  const double grown = slack_m + k_thickness * (1.0 + reach.x + reach.y + reach.z);
  near.min -= grown;
  near.max += grown;

  glm::ivec3 side(0);  // of the box that the eye is on, by axis
  std::optional<glm::dvec3> towards_eye;
  if (sort == RaySort::from_a_point) {
    for (int axis = 0; axis < 3; ++axis)
      side[axis] = near.min[axis] > 0.0 ? -1 : near.max[axis] < 0.0 ? 1 : 0;
  } else if (sort == RaySort::parallel) {
    towards_eye = world_from_camera * towards_eye_of(eye.clip_from_camera);
    for (int axis = 0; axis < 3; ++axis)
      side[axis] = (*towards_eye)[axis] < 0.0 ? -1 : (*towards_eye)[axis] > 0.0 ? 1 : 0;
  }
  if (side == glm::ivec3(0)) {
    everything_ = true;
    return;
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (side[axis] < 0) low_[axis] = near.min[axis];
    if (side[axis] > 0) high_[axis] = near.max[axis];
  }
  add_outline(near, side, towards_eye ? &*towards_eye : nullptr);
}

/// An edge belongs to the outline when the eye sees one of its two faces and not the other.
void OccluderShadow::add_outline(const WorldBox& box, const glm::ivec3& side,
                                 const glm::dvec3* towards_eye) noexcept {
  const glm::dvec3 center = 0.5 * (box.min + box.max);
  for (int along = 0; along < 3; ++along) {
    const int b = (along + 1) % 3, c = (along + 2) % 3;
    for (const int side_b : {-1, 1}) {
      for (const int side_c : {-1, 1}) {
        if ((side[b] == side_b) == (side[c] == side_c)) continue;
        glm::dvec3 on_edge = center, direction(0.0);
        on_edge[b] = side_b < 0 ? box.min[b] : box.max[b];
        on_edge[c] = side_c < 0 ? box.min[c] : box.max[c];
        direction[along] = 1.0;
        glm::dvec3 normal = glm::cross(direction, towards_eye != nullptr ? *towards_eye : on_edge);
        const double length = glm::length(normal);
        if (!(length > 0.0) || plane_count_ == planes_.size()) continue;
        normal /= length;
        if (glm::dot(normal, center - on_edge) < 0.0) normal = -normal;
        const double offset = towards_eye != nullptr ? -glm::dot(normal, on_edge) : 0.0;
        planes_[plane_count_++] = glm::dvec4(normal, offset);
      }
    }
  }
}

bool OccluderShadow::may_hold(const Aabb& world_bounds) const noexcept {
  if (world_bounds.empty()) return false;
  if (everything_) return true;
  const glm::dvec3 low = glm::dvec3(world_bounds.min) - origin_m_ - slack_m_;
  const glm::dvec3 high = glm::dvec3(world_bounds.max) - origin_m_ + slack_m_;
  for (int axis = 0; axis < 3; ++axis) {
    if (high[axis] < low_[axis] || low[axis] > high_[axis]) return false;
  }
  const glm::dvec3 reach = glm::max(glm::abs(low), glm::abs(high));
  const double rounding = 1e-12 * (1.0 + reach.x + reach.y + reach.z);
  for (std::size_t i = 0; i < plane_count_; ++i) {
    const glm::dvec4& plane = planes_[i];
    double farthest_in = plane.w;
    for (int axis = 0; axis < 3; ++axis)
      farthest_in += std::max(plane[axis] * low[axis], plane[axis] * high[axis]);
    if (farthest_in < -rounding) return false;
  }
  return true;
}

}  // namespace sightline
