#include "common/pose.hpp"

#include <cmath>

namespace sightline {

double rotation_angle_rad(const glm::dquat& a, const glm::dquat& b) noexcept {
  // atan2 of sine and cosine of the half angle: acos of the cosine alone loses every angle below 1e-8.
  const glm::dquat turn = glm::conjugate(a) * b;
  return 2.0 * std::atan2(std::hypot(turn.x, turn.y, turn.z), std::abs(turn.w));
}

glm::dmat4 camera_from_world(const Pose& pose) noexcept {
  const glm::dmat3 rotation = glm::mat3_cast(glm::conjugate(pose.world_from_camera));
  glm::dmat4 matrix(rotation);
  matrix[3] = glm::dvec4(-(rotation * pose.position_m), 1.0);
  return matrix;
}

Pose pose_of(const glm::dmat4& camera_from_world) noexcept {
  const glm::dmat3 world_from_camera = glm::transpose(glm::dmat3(camera_from_world));
  return {-(world_from_camera * glm::dvec3(camera_from_world[3])),
          glm::normalize(glm::quat_cast(world_from_camera))};
}

}  // namespace sightline
