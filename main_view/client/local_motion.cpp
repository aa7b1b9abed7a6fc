#include "main_view/client/local_motion.hpp"

#include <cmath>

namespace sightline {

LocalMotion motion_between(const Pose& from, const Pose& to) noexcept {
  const glm::dquat camera_from_world = glm::conjugate(from.world_from_camera);
  const glm::dvec3 step_m = camera_from_world * (to.position_m - from.position_m);
  glm::dquat turn = camera_from_world * to.world_from_camera;
  if (turn.w < 0.0) turn = -turn;
  const double sine = std::hypot(turn.x, turn.y, turn.z);
  // The angle over its half's sine; 2 in the limit.
  const double scale = sine > 1e-12 ? 2.0 * std::atan2(sine, turn.w) / sine : 2.0;
  return {step_m.x, step_m.y, step_m.z, scale * turn.x, scale * turn.y, scale * turn.z};
}

Pose moved(const Pose& from, const LocalMotion& motion) noexcept {
  const double angle_rad = turn_rad(motion);
  const double scale = angle_rad > 1e-12 ? std::sin(0.5 * angle_rad) / angle_rad : 0.5;
  const glm::dquat turn(std::cos(0.5 * angle_rad), scale * motion[3], scale * motion[4], scale * motion[5]);
  return {from.position_m + from.world_from_camera * glm::dvec3(motion[0], motion[1], motion[2]),
          glm::normalize(from.world_from_camera * turn)};
}

double translation_m(const LocalMotion& motion) noexcept {
  return std::hypot(motion[0], motion[1], motion[2]);
}

double turn_rad(const LocalMotion& motion) noexcept {
  return std::hypot(motion[3], motion[4], motion[5]);
}

LocalMotion operator-(const LocalMotion& a, const LocalMotion& b) noexcept {
  LocalMotion difference;
  for (std::size_t axis = 0; axis < k_motion_axis_count; ++axis) difference[axis] = a[axis] - b[axis];
  return difference;
}

}  // namespace sightline
