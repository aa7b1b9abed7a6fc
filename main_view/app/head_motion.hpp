#pragma once

#include <filesystem>
#include <optional>

#include "common/camera_path.hpp"

namespace sightline {

/// What `audit` lays over the rotation of a path. Both may be given; the head then turns on top of the trace.
struct HeadMotionOptions {
  std::filesystem::path rotations;  ///< recorded head, camera path CSV; empty for none
  double turn_deg_per_s = 0.0;  ///< speed of synthetic head turns; 0 for none, infinity for turns in no time

  [[nodiscard]] bool any() const noexcept { return !rotations.empty() || turn_deg_per_s != 0.0; }
  /// Throws InputError naming the option that is wrong.
  void validate() const;
};

/// Rotations added to a camera's own, as functions of time alone: where the camera is does not change.
///
/// A recorded head: its longest stretch without a gap of more than 0.1 s, played forwards, then backwards,
/// and so on. Each rotation is taken relative to the stretch's first, in the recorded camera's frame, so the
/// recording's world axes do not matter.
///
/// A synthetic head: still for k_still_s, then turned by half a circle to the left about the world's up axis,
/// and so on. It takes k_ramp_s to reach its speed and k_ramp_s to stop. With an infinite speed it jumps
/// instead, at the end of each k_still_s.
class HeadMotion {
 public:
  static constexpr double k_still_s = 2.0;
  static constexpr double k_ramp_s = 0.1;
  static constexpr double k_fastest_deg_per_s =
      1500.0;  ///< ramps at both ends of half a circle leave no more

  /// No rotation at all.
  HeadMotion() = default;
  /// Throws InputError naming the file when it cannot be read or nothing in it lasts.
  explicit HeadMotion(const HeadMotionOptions& options);
  HeadMotion(std::optional<CameraPath> recorded, double turn_deg_per_s);

  /// `pose` with the head turned as it is `elapsed_s` >= 0 into the motion. Exactly `pose` without any.
  [[nodiscard]] Pose applied_to(const Pose& pose, double elapsed_s) const;

 private:
  [[nodiscard]] double turned_rad(double elapsed_s) const;

  std::optional<CameraPath> recorded_;  ///< one stretch
  double turn_deg_per_s_ = 0.0;
};

}  // namespace sightline
