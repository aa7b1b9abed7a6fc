#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "main_view/client/local_motion.hpp"

namespace sightline {

/// A least-squares polynomial over the newest poses.
struct FitShape {
  int order;
  std::size_t window;
};

/// The fits that a prediction is blended from, from quick to calm. The first follows every move and all
/// noise; the last is the paper's.
inline constexpr std::array<FitShape, 5> k_fit_bank{{{1, 2}, {1, 4}, {1, 8}, {2, 8}, {2, 20}}};
inline constexpr std::size_t k_fit_count = k_fit_bank.size();
inline constexpr std::size_t k_fit_bank_window = 20;  ///< poses that the longest looks back on

/// One fit: the movement from the newest pose as a polynomial of the lead. At a lead of zero it is not quite
/// zero, for a fit smooths.
struct MotionFit {
  std::array<LocalMotion, 3> coefficients{};  ///< of 1, lead_s, lead_s^2

  [[nodiscard]] LocalMotion at(double lead_s) const noexcept;
};

using FitBank = std::array<MotionFit, k_fit_count>;

/// Fits the bank in the frame of the newest sample, where a turn is a vector. Near the beginning, windows are
/// shorter and orders lower. Requires one sample at least, times strictly increasing, and unit quaternions.
[[nodiscard]] FitBank fit_bank(std::span<const TimedPose> samples);

}  // namespace sightline
