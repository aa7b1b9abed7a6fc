#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "main_view/client/local_motion.hpp"

namespace sightline {

/// The numbers a pose is fitted by: x, y, z, then the quaternion's w, x, y, z.
inline constexpr std::size_t k_pose_component_count = 7;
using PoseComponents = std::array<double, k_pose_component_count>;

/// One polynomial a component, read off at one time.
struct Extrapolation {
  PoseComponents value{};
  /// Variance of a new observation there, s^2 (1 + x^T (A^T A)^-1 x), s^2 from the residuals. Only with
  /// `residuals_known`.
  PoseComponents variance{};
  bool residuals_known = false;  ///< there were more samples than coefficients
};

/// Least-squares polynomials of `order` through (times_s, values), read off at `at_time_s`.
/// Solved with ceres::TinySolver; time is centred and scaled to [-1, 1], values are taken relative to the
/// newest sample. Requires as many values as times, at least order + 1 of them, times strictly increasing, 0
/// <= order <= k_max_predictor_order.
[[nodiscard]] Extrapolation fit_and_extrapolate(std::span<const double> times_s,
                                                std::span<const PoseComponents> values, int order,
                                                double at_time_s);

/// Least-squares polynomials of `order` through (lead_s, motion): their coefficients of 1, lead_s and
/// lead_s^2; those above the order are zero. Solved with ceres::TinySolver. Requires as many motions as
/// leads, at least order + 1 of them, leads strictly increasing up to zero, 0 <= order <= 2.
[[nodiscard]] std::array<LocalMotion, 3> fit_motion(std::span<const double> lead_s,
                                                    std::span<const LocalMotion> motion, int order);

}  // namespace sightline
