#include "main_view/client/polynomial_fit.hpp"

#include <Eigen/Dense>
#include <utility>

#include <ceres/tiny_solver.h>

#include "main_view/client/culling_options.hpp"

namespace sightline {
namespace {

/// As many rows as samples; Eigen::Dynamic for any number of them, at several times the cost.
template <int ParameterCount, int SampleCount = Eigen::Dynamic>
using Powers = Eigen::Matrix<double, SampleCount, ParameterCount>;

/// Residuals of one component: polynomial minus sample. Linear, so the Jacobian is the matrix of powers
/// itself.
template <int ParameterCount, int SampleCount = Eigen::Dynamic>
struct ComponentResiduals {
  using Scalar = double;
  // Names that TinySolver asks for.
  // NOLINTNEXTLINE(readability-identifier-naming)
  enum { NUM_RESIDUALS = SampleCount, NUM_PARAMETERS = ParameterCount };

  const Powers<ParameterCount, SampleCount>& powers;
  const Eigen::Matrix<double, SampleCount, 1>& samples;

  // NOLINTNEXTLINE(readability-identifier-naming)
  [[nodiscard]] int NumResiduals() const { return static_cast<int>(powers.rows()); }

  bool operator()(const double* parameters, double* residuals, double* jacobian) const {
    const Eigen::Map<const Eigen::Matrix<double, ParameterCount, 1>> coefficients(parameters);
    Eigen::Map<Eigen::Matrix<double, SampleCount, 1>>(residuals, powers.rows()).noalias() =
        powers * coefficients - samples;
    if (jacobian != nullptr)
      Eigen::Map<Powers<ParameterCount, SampleCount>>(jacobian, powers.rows(), ParameterCount) = powers;
    return true;
  }
};

template <int ParameterCount>
Eigen::Matrix<double, ParameterCount, 1> powers_of(double x) {
  Eigen::Matrix<double, ParameterCount, 1> row;
  row[0] = 1.0;
  for (int i = 1; i < ParameterCount; ++i) row[i] = row[i - 1] * x;
  return row;
}

/// Options for a linear problem: it is solved by one undamped step; a second polishes what the first rounded
/// away. TinySolver's cost tolerances are absolute, and a cost of 1e-12 square metres still matters here.
template <int ParameterCount, int SampleCount = Eigen::Dynamic>
ceres::TinySolver<ComponentResiduals<ParameterCount, SampleCount>> linear_solver(int steps) {
  ceres::TinySolver<ComponentResiduals<ParameterCount, SampleCount>> solver;
  solver.options.initial_trust_region_radius = 1e16;
  solver.options.max_num_iterations = 1 + steps;
  solver.options.function_tolerance = 0.0;
  solver.options.cost_threshold = 0.0;
  solver.options.gradient_tolerance = 0.0;
  solver.options.parameter_tolerance = 1e-12;
  return solver;
}

template <int ParameterCount>
Extrapolation fit(std::span<const double> times_s, std::span<const PoseComponents> values, double at_time_s) {
  const auto count = static_cast<Eigen::Index>(times_s.size());
  const double centre_s = 0.5 * (times_s.front() + times_s.back());
  const double half_span_s = count > 1 ? 0.5 * (times_s.back() - times_s.front()) : 1.0;

  Powers<ParameterCount> powers(count, ParameterCount);
  for (Eigen::Index i = 0; i < count; ++i) {
    powers.row(i) =
        powers_of<ParameterCount>((times_s[static_cast<std::size_t>(i)] - centre_s) / half_span_s);
  }
  const auto at = powers_of<ParameterCount>((at_time_s - centre_s) / half_span_s);

  Extrapolation result;
  result.residuals_known = count > ParameterCount;
  double leverage = 0.0;
  if (result.residuals_known) {
    const Eigen::Matrix<double, ParameterCount, ParameterCount> normal = powers.transpose() * powers;
    leverage = at.dot(normal.ldlt().solve(at));
  }

  auto solver = linear_solver<ParameterCount>(2);
  Eigen::VectorXd samples(count);
  for (std::size_t component = 0; component < k_pose_component_count; ++component) {
    const double newest = values.back()[component];
    for (Eigen::Index i = 0; i < count; ++i)
      samples[i] = values[static_cast<std::size_t>(i)][component] - newest;
    Eigen::Matrix<double, ParameterCount, 1> coefficients = Eigen::Matrix<double, ParameterCount, 1>::Zero();
    solver.Solve(ComponentResiduals<ParameterCount>{powers, samples}, &coefficients);
    result.value[component] = newest + at.dot(coefficients);
    if (result.residuals_known) {
      const double residual_variance =
          (powers * coefficients - samples).squaredNorm() / static_cast<double>(count - ParameterCount);
      result.variance[component] = residual_variance * (1.0 + leverage);
    }
  }
  return result;
}

template <int ParameterCount, int SampleCount>
std::array<LocalMotion, 3> fit_motion_of(std::span<const double> lead_s,
                                         std::span<const LocalMotion> motion) {
  const auto count = static_cast<Eigen::Index>(lead_s.size());
  const double span_s = count > 1 ? -lead_s.front() : 1.0;
  Powers<ParameterCount, SampleCount> powers(count, ParameterCount);
  for (Eigen::Index i = 0; i < count; ++i)
    powers.row(i) = powers_of<ParameterCount>(lead_s[static_cast<std::size_t>(i)] / span_s);

  auto solver = linear_solver<ParameterCount, SampleCount>(1);
  std::array<LocalMotion, 3> result{};
  Eigen::Matrix<double, SampleCount, 1> samples(count);
  for (std::size_t axis = 0; axis < k_motion_axis_count; ++axis) {
    for (Eigen::Index i = 0; i < count; ++i) samples[i] = motion[static_cast<std::size_t>(i)][axis];
    Eigen::Matrix<double, ParameterCount, 1> coefficients = Eigen::Matrix<double, ParameterCount, 1>::Zero();
    solver.Solve(ComponentResiduals<ParameterCount, SampleCount>{powers, samples}, &coefficients);
    double unit = 1.0;
    for (int i = 0; i < ParameterCount; ++i, unit /= span_s)
      result[static_cast<std::size_t>(i)][axis] = coefficients[i] * unit;
  }
  return result;
}

/// The shapes of k_fit_bank are compiled for their very size; others come near a motion's beginning alone.
template <int ParameterCount>
std::array<LocalMotion, 3> fit_motion_by_count(std::span<const double> lead_s,
                                               std::span<const LocalMotion> motion) {
  switch (lead_s.size()) {
    case 2:
      if constexpr (ParameterCount <= 2) return fit_motion_of<ParameterCount, 2>(lead_s, motion);
      break;
    case 4:
      return fit_motion_of<ParameterCount, 4>(lead_s, motion);
    case 8:
      return fit_motion_of<ParameterCount, 8>(lead_s, motion);
    case 20:
      return fit_motion_of<ParameterCount, 20>(lead_s, motion);
    default:
      break;
  }
  return fit_motion_of<ParameterCount, Eigen::Dynamic>(lead_s, motion);
}

}  // namespace

std::array<LocalMotion, 3> fit_motion(std::span<const double> lead_s, std::span<const LocalMotion> motion,
                                      int order) {
  switch (order) {
    case 0:
      return fit_motion_by_count<1>(lead_s, motion);
    case 1:
      return fit_motion_by_count<2>(lead_s, motion);
    default:
      return fit_motion_by_count<3>(lead_s, motion);
  }
}

Extrapolation fit_and_extrapolate(std::span<const double> times_s, std::span<const PoseComponents> values,
                                  int order, double at_time_s) {
  static_assert(k_max_predictor_order == 3, "one case an order");
  switch (order) {
    case 0:
      return fit<1>(times_s, values, at_time_s);
    case 1:
      return fit<2>(times_s, values, at_time_s);
    case 2:
      return fit<3>(times_s, values, at_time_s);
    default:
      return fit<4>(times_s, values, at_time_s);
  }
}

}  // namespace sightline
