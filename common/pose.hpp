#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace sightline {

/// Where a camera is and how it is turned. World frame: right-handed, Y up, metres.
/// The camera looks down its own -Z, +X is right, +Y is up (the glTF convention).
struct Pose {
  glm::dvec3 position_m{0.0};
  glm::dquat world_from_camera{1.0, 0.0, 0.0, 0.0};  ///< unit; glm order (w, x, y, z)

  bool operator==(const Pose&) const = default;
};

/// A pose and when it held, in seconds of the client's own monotonic clock.
struct TimedPose {
  double time_s = 0.0;
  Pose pose;
};

/// Angle between two orientations, radians in [0, pi]; q and -q are the same orientation.
[[nodiscard]] double rotation_angle_rad(const glm::dquat& a, const glm::dquat& b) noexcept;

/// The rigid transform that takes world coordinates to camera coordinates.
[[nodiscard]] glm::dmat4 camera_from_world(const Pose& pose) noexcept;

/// The pose of a rigid camera_from_world matrix (rotation and translation; the inverse of the above).
[[nodiscard]] Pose pose_of(const glm::dmat4& camera_from_world) noexcept;

}  // namespace sightline
