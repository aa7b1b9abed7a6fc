#include "main_view/client/fit_bank.hpp"

#include <algorithm>
#include <vector>

#include "main_view/client/polynomial_fit.hpp"

namespace sightline {

LocalMotion MotionFit::at(double lead_s) const noexcept {
  LocalMotion motion;
  for (std::size_t axis = 0; axis < k_motion_axis_count; ++axis) {
    motion[axis] = coefficients[0][axis] + lead_s * (coefficients[1][axis] + lead_s * coefficients[2][axis]);
  }
  return motion;
}

FitBank fit_bank(std::span<const TimedPose> samples) {
  samples = samples.last(std::min(samples.size(), k_fit_bank_window));
  std::array<double, k_fit_bank_window> lead_s;
  std::array<LocalMotion, k_fit_bank_window> motion;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    lead_s[i] = samples[i].time_s - samples.back().time_s;
    motion[i] = motion_between(samples.back().pose, samples[i].pose);
  }
  FitBank bank;
  for (std::size_t i = 0; i < k_fit_count; ++i) {
    const std::size_t count = std::min(k_fit_bank[i].window, samples.size());
    const std::size_t first = samples.size() - count;
    const int order = std::min(k_fit_bank[i].order, static_cast<int>(count) - 1);
    bank[i].coefficients = fit_motion({&lead_s[first], count}, {&motion[first], count}, order);
  }
  return bank;
}

}  // namespace sightline
