#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/pose.hpp"
#include "main_view/client/culling_options.hpp"

namespace sightline {

/// The last poses of the camera, oldest first: strictly increasing times, unit quaternions, consecutive ones
/// on the same half of the sphere (so that components can be fitted as curves).
class PoseHistory {
 public:
  explicit PoseHistory(const CullingOptions& options);

  enum class Added {
    continued,  ///< it goes on from the poses before
    restarted,  ///< first pose, or first after a pause longer than pose_gap_s: the older poses were forgotten
    jumped,     ///< too far from the pose before for any motion: the older poses were forgotten
    ignored     ///< its time lies before the newest pose's; nothing changed
  };

  /// A pose less than k_least_step_s after the newest held one takes its place, at its time: over so short a
  /// step a millimetre of noise would be a speed of metres a second. Quaternions are normalised.
  /// Throws InputError for a pose that is not finite or has no direction (a zero quaternion); nothing changed
  /// then.
  Added add(const TimedPose& sample);

  static constexpr double k_least_step_s = 5e-4;

  void clear() noexcept { samples_.clear(); }
  [[nodiscard]] bool empty() const noexcept { return samples_.empty(); }
  [[nodiscard]] std::span<const TimedPose> samples() const noexcept { return samples_; }
  /// The newest pose exactly as it was given: not normalised, sign as it came. Requires !empty().
  [[nodiscard]] const TimedPose& newest() const noexcept { return newest_as_given_; }
  /// All held poses are equal to the bit (true for one).
  [[nodiscard]] bool still() const noexcept;

  /// Largest speeds between consecutive held poses; 0 with fewer than two.
  [[nodiscard]] double speed_m_per_s() const noexcept;
  [[nodiscard]] double turn_speed_rad_per_s() const noexcept;

 private:
  [[nodiscard]] bool is_jump(const TimedPose& from, const TimedPose& to) const noexcept;

  CullingOptions options_;
  std::size_t limit_;  ///< poses held: the window, but two at least, for the speed
  std::vector<TimedPose> samples_;
  /// Of the last two poses, even where the later one was taken for a jump: a second step like the first is
  /// motion.
  glm::dvec3 last_velocity_m_per_s_{0.0};
  TimedPose newest_as_given_;
};

}  // namespace sightline
