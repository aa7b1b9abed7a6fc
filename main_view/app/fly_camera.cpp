#include "main_view/app/fly_camera.hpp"

#include <algorithm>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

namespace sightline {
namespace {

constexpr double k_max_pitch_rad = 1.55;

}  // namespace

FlyCamera::FlyCamera(const Pose& pose) : position_m_(pose.position_m) {
  const glm::dvec3 forward = pose.world_from_camera * glm::dvec3(0.0, 0.0, -1.0);
  yaw_rad_ = std::atan2(-forward.x, -forward.z);
  pitch_rad_ = std::clamp(std::asin(std::clamp(forward.y, -1.0, 1.0)), -k_max_pitch_rad, k_max_pitch_rad);
}

void FlyCamera::turn(double yaw_rad, double pitch_rad) {
  yaw_rad_ = std::remainder(yaw_rad_ + yaw_rad, 2.0 * 3.14159265358979323846);
  pitch_rad_ = std::clamp(pitch_rad_ + pitch_rad, -k_max_pitch_rad, k_max_pitch_rad);
}

void FlyCamera::move(double right_m, double up_m, double forward_m) {
  const glm::dquat turned = pose().world_from_camera;
  position_m_ += turned * glm::dvec3(right_m, 0.0, -forward_m) + glm::dvec3(0.0, up_m, 0.0);
}

Pose FlyCamera::pose() const {
  const glm::dquat yaw = glm::angleAxis(yaw_rad_, glm::dvec3(0.0, 1.0, 0.0));
  const glm::dquat pitch = glm::angleAxis(pitch_rad_, glm::dvec3(1.0, 0.0, 0.0));
  return {position_m_, yaw * pitch};
}

Pose overview_of(const Aabb& bounds, const glm::dvec3& origin_m) {
  const glm::dvec3 center = glm::dvec3(bounds.center()) + origin_m;
  const double radius = std::max(0.5 * glm::length(glm::dvec3(bounds.extent())), 1e-3);
  const glm::dvec3 eye = center + radius * glm::dvec3(1.0, 0.9, 1.4);
  return pose_of(glm::lookAt(eye, center, glm::dvec3(0.0, 1.0, 0.0)));
}

}  // namespace sightline
