#pragma once

#include <glm/vec3.hpp>

#include "common/bounds.hpp"
#include "common/pose.hpp"

namespace sightline {

/// A camera that a person flies: it looks anywhere, never rolls, and moves where it looks.
class FlyCamera {
 public:
  FlyCamera() = default;
  /// Takes over a pose's place and view direction; its roll is lost.
  explicit FlyCamera(const Pose& pose);

  /// Positive yaw turns left, positive pitch up; radians. Pitch stops short of straight up and down.
  void turn(double yaw_rad, double pitch_rad);
  /// Moves by metres along the camera's right, the world's up and the view direction.
  void move(double right_m, double up_m, double forward_m);

  [[nodiscard]] Pose pose() const;

 private:
  glm::dvec3 position_m_{0.0};
  double yaw_rad_ = 0.0;
  double pitch_rad_ = 0.0;
};

/// A place outside the box (world frame) from which all of it is in view.
[[nodiscard]] Pose overview_of(const Aabb& bounds, const glm::dvec3& origin_m);

}  // namespace sightline
