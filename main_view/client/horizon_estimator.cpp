#include "main_view/client/horizon_estimator.hpp"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

// An interval and a bit would do for a set after now to be there always. The further half keeps the nearest
// of them from being for a moment so close that the prediction's error matters more than the lead: a camera
// that passes through a door sees all of the next room within a centimetre.
constexpr double k_interval_factor = 1.6;

}  // namespace

void SmoothedValue::add(double sample) noexcept {
  if (!mean_) {
    mean_ = sample;
    deviation_ = 0.25 * sample;
    return;
  }
  deviation_ += 0.25 * (std::abs(sample - *mean_) - deviation_);
  *mean_ += 0.125 * (sample - *mean_);
}

HorizonEstimator::HorizonEstimator(const CullingOptions& options)
    : initial_s_(options.initial_horizon_s), max_s_(options.max_horizon_s) {}

void HorizonEstimator::observe(double issued_s, double received_s) noexcept {
  round_trip_.add(std::clamp(received_s - issued_s, 0.0, 10.0));
  if (last_issued_s_ && issued_s > *last_issued_s_) interval_.add(std::min(issued_s - *last_issued_s_, 10.0));
  if (!last_issued_s_ || issued_s > *last_issued_s_) last_issued_s_ = issued_s;
}

double HorizonEstimator::horizon_s() const noexcept {
  if (round_trip_.empty()) return initial_s_;
  if (round_trip_.upper() == 0.0) return 0.0;
  return std::min(round_trip_.upper() + k_interval_factor * interval_.upper(), max_s_);
}

}  // namespace sightline
