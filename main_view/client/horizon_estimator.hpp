#pragma once

#include <optional>

#include "main_view/client/culling_options.hpp"

namespace sightline {

/// A running mean and mean deviation, as TCP smooths its round trip (RFC 6298): new samples weigh 1/8 and
/// 1/4.
class SmoothedValue {
 public:
  void add(double sample) noexcept;
  [[nodiscard]] bool empty() const noexcept { return !mean_.has_value(); }
  [[nodiscard]] double mean() const noexcept { return mean_.value_or(0.0); }
  /// Mean plus two deviations: most samples lie below.
  [[nodiscard]] double upper() const noexcept { return mean() + 2.0 * deviation_; }

 private:
  std::optional<double> mean_;
  double deviation_ = 0.0;
};

/// How far ahead to ask.
///
/// A set for time t is wanted in hand before t, and until the next one arrives: so the horizon is the round
/// trip, its spread, and the time between answered requests. Then a set for a time after now is nearly always
/// held. Exactly zero while every round trip measured zero (a lock-step client): the set is for the very pose
/// that is drawn.
class HorizonEstimator {
 public:
  explicit HorizonEstimator(const CullingOptions& options);

  /// A request issued at `issued_s` was answered at `received_s`, client's clock. Answers may come in any
  /// order.
  void observe(double issued_s, double received_s) noexcept;
  /// The daemon was away: the pause is no interval between answers.
  void restart_interval() noexcept { last_issued_s_.reset(); }

  /// options.initial_horizon_s before the first answer; never above options.max_horizon_s.
  [[nodiscard]] double horizon_s() const noexcept;
  /// Between consecutive answered requests, most of the time no longer than this; 0 before two of them.
  [[nodiscard]] double answer_interval_s() const noexcept { return interval_.upper(); }

 private:
  double initial_s_;
  double max_s_;
  SmoothedValue round_trip_;
  SmoothedValue interval_;
  std::optional<double> last_issued_s_;
};

}  // namespace sightline
