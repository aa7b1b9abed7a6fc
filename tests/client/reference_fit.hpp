#pragma once

#include <span>

#include "main_view/client/polynomial_fit.hpp"

namespace sightline::testing {

/// The plain version of fit_and_extrapolate: one QR factorization for all components.
[[nodiscard]] PoseComponents closed_form_value(std::span<const double> times_s,
                                               std::span<const PoseComponents> values, int order,
                                               double at_time_s);

/// The same by ceres::Problem and the full solver, one residual block a component.
[[nodiscard]] PoseComponents full_solver_value(std::span<const double> times_s,
                                               std::span<const PoseComponents> values, int order,
                                               double at_time_s);

}  // namespace sightline::testing
