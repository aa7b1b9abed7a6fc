#pragma once

#include "common/bounds.hpp"

namespace sightline {

/// How a box that is given anew each frame moves: each of its six faces goes on at the speed of its last
/// step. World frame, metres, seconds of the client's clock.
class BoxMotion {
 public:
  BoxMotion() = default;

  /// It was `before` until `from_s` and is `after` at `to_s`. Returns false when that was a jump, as
  /// ObjectMotion says of its own: it then counts as being at rest.
  bool step(double from_s, double to_s, const WorldBox& before, const WorldBox& after) noexcept;
  void stop() noexcept { speed_m_per_s_ = {}; }

  /// Box around `now`, where it is at the last step, and where it goes between two times. Contains the whole
  /// extrapolated way. Times before the last step's count as that.
  [[nodiscard]] WorldBox bounds_between(const WorldBox& now, double from_s, double to_s) const noexcept;
  /// Of its fastest corner.
  [[nodiscard]] double speed_m_per_s() const noexcept;
  /// From one box to the next, the last time.
  [[nodiscard]] double step_s() const noexcept { return step_s_; }

 private:
  WorldBox speed_m_per_s_{};  ///< of the faces; min may be above max
  double time_s_ = 0.0;
  double step_s_ = 0.0;
  double last_way_m_ = 0.0;  ///< of the last step, even if that was a jump
};

}  // namespace sightline
