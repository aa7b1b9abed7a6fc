#include "tests/client/reference_fit.hpp"

#include <Eigen/Dense>
#include <array>
#include <utility>
#include <vector>

#include <ceres/ceres.h>

namespace sightline::testing {
namespace {

struct Scaled {
  Eigen::MatrixXd powers;
  Eigen::VectorXd at;
  Eigen::MatrixXd samples;  ///< a column a component, relative to the newest
};

Scaled scaled(std::span<const double> times_s, std::span<const PoseComponents> values, int order,
              double at_time_s) {
  const auto count = static_cast<Eigen::Index>(times_s.size());
  const double centre_s = 0.5 * (times_s.front() + times_s.back());
  const double half_span_s = count > 1 ? 0.5 * (times_s.back() - times_s.front()) : 1.0;
  const auto row = [&](double time_s) {
    Eigen::VectorXd powers(order + 1);
    for (int i = 0; i <= order; ++i) powers[i] = std::pow((time_s - centre_s) / half_span_s, i);
    return powers;
  };
  Scaled result{Eigen::MatrixXd(count, order + 1), row(at_time_s),
                Eigen::MatrixXd(count, static_cast<Eigen::Index>(k_pose_component_count))};
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto sample = static_cast<std::size_t>(i);
    result.powers.row(i) = row(times_s[sample]);
    for (std::size_t component = 0; component < k_pose_component_count; ++component) {
      result.samples(i, static_cast<Eigen::Index>(component)) =
          values[sample][component] - values.back()[component];
    }
  }
  return result;
}

class LinearResiduals final : public ceres::CostFunction {
 public:
  LinearResiduals(const Eigen::MatrixXd& powers, Eigen::VectorXd samples)
      : powers_(powers), samples_(std::move(samples)) {
    set_num_residuals(static_cast<int>(powers.rows()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(powers.cols()));
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Map<const Eigen::VectorXd> coefficients(parameters[0], powers_.cols());
    Eigen::Map<Eigen::VectorXd>(residuals, powers_.rows()) = powers_ * coefficients - samples_;
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      Eigen::Map<RowMajor>(jacobians[0], powers_.rows(), powers_.cols()) = powers_;
    }
    return true;
  }

 private:
  const Eigen::MatrixXd& powers_;
  Eigen::VectorXd samples_;
};

}  // namespace

PoseComponents closed_form_value(std::span<const double> times_s, std::span<const PoseComponents> values,
                                 int order, double at_time_s) {
  const Scaled problem = scaled(times_s, values, order, at_time_s);
  const Eigen::MatrixXd coefficients = problem.powers.householderQr().solve(problem.samples);
  PoseComponents result{};
  for (std::size_t component = 0; component < k_pose_component_count; ++component) {
    result[component] =
        values.back()[component] + problem.at.dot(coefficients.col(static_cast<Eigen::Index>(component)));
  }
  return result;
}

PoseComponents full_solver_value(std::span<const double> times_s, std::span<const PoseComponents> values,
                                 int order, double at_time_s) {
  const Scaled scaled_problem = scaled(times_s, values, order, at_time_s);
  std::array<Eigen::VectorXd, k_pose_component_count> coefficients;
  ceres::Problem problem;
  for (std::size_t component = 0; component < k_pose_component_count; ++component) {
    coefficients[component] = Eigen::VectorXd::Zero(order + 1);
    problem.AddResidualBlock(
        new LinearResiduals(scaled_problem.powers,
                            scaled_problem.samples.col(static_cast<Eigen::Index>(component))),
        nullptr, coefficients[component].data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.initial_trust_region_radius = 1e16;
  options.function_tolerance = 1e-15;
  options.gradient_tolerance = 1e-15;
  options.parameter_tolerance = 1e-12;
  options.max_num_iterations = 3;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  PoseComponents result{};
  for (std::size_t component = 0; component < k_pose_component_count; ++component) {
    result[component] = values.back()[component] + scaled_problem.at.dot(coefficients[component]);
  }
  return result;
}

}  // namespace sightline::testing
