#include "main_view/client/fit_blend.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

namespace sightline {
namespace {

using Matrix = Eigen::Matrix<double, k_fit_count, k_fit_count>;
using Vector = Eigen::Matrix<double, k_fit_count, 1>;

constexpr double k_shared = 0.05;  // of what each axis of a kind learns, to all three
// The pull towards the first fit alone: as strong as the evidence with this many outcomes, falling with their
// square, and never below a share of it. More would keep a bit of the first fit where all fits are noise, and
// far ahead even a bit is much.
constexpr double k_prior_outcomes = 8.0;
constexpr double k_damping = 0.004;
constexpr std::size_t k_axes_of_a_kind = 3;

}  // namespace

BankMotions motions_at(const FitBank& bank, double lead_s) noexcept {
  BankMotions motions;
  for (std::size_t i = 0; i < k_fit_count; ++i) {
    motions[i] = bank[i].at(lead_s);
    if (i > 0) motions[i] = motions[i] - motions[0];
  }
  return motions;
}

LocalMotion blended(const BankMotions& motions, const FitBlend::Weights& weights) noexcept {
  LocalMotion sum{};
  for (std::size_t axis = 0; axis < k_motion_axis_count; ++axis) {
    for (std::size_t i = 0; i < k_fit_count; ++i) sum[axis] += weights[axis][i] * motions[i][axis];
  }
  return sum;
}

FitBlend::FitBlend() noexcept {
  for (auto& weights : weights_) {
    weights.fill(0.0);
    weights[0] = 1.0;
  }
}

void FitBlend::learn(const BankMotions& motions, const LocalMotion& truth, double keep) noexcept {
  for (std::size_t axis = 0; axis < k_motion_axis_count; ++axis) {
    Normal& normal = normal_[axis];
    const double surprise = truth[axis] - motions[0][axis];
    for (std::size_t i = 0; i < k_fit_count; ++i) {
      for (std::size_t j = i; j < k_fit_count; ++j) {
        double& a = normal.a[i * k_fit_count + j];
        a = keep * a + motions[i][axis] * motions[j][axis];
      }
      normal.b[i] = keep * normal.b[i] + motions[i][axis] * surprise;
    }
  }
  evidence_ = keep * evidence_ + 1.0;
}

void FitBlend::solve() {
  if (evidence_ <= 0.0) return;
  for (std::size_t kind = 0; kind < k_motion_axis_count; kind += k_axes_of_a_kind) {
    Matrix all_a = Matrix::Zero();
    Vector all_b = Vector::Zero();
    for (std::size_t axis = kind; axis < kind + k_axes_of_a_kind; ++axis) {
      all_a += Eigen::Map<const Matrix>(normal_[axis].a.data());
      all_b += Eigen::Map<const Vector>(normal_[axis].b.data());
    }
    // Energy below which a fit has said nothing: keeps a still axis solvable.
    const double floor = 1e-9 * all_a.trace() + std::numeric_limits<double>::min() * 1e16;
    const double pull = k_damping + std::pow(k_prior_outcomes / evidence_, 2);
    for (std::size_t axis = kind; axis < kind + k_axes_of_a_kind; ++axis) {
      Matrix a = Eigen::Map<const Matrix>(normal_[axis].a.data()) + k_shared * all_a;
      const Vector b = Eigen::Map<const Vector>(normal_[axis].b.data()) + k_shared * all_b;
      const Vector energy = a.diagonal() + 0.1 * k_shared * all_a.diagonal();
      a.diagonal() += pull * energy + Vector::Constant(floor);
      const Vector change = a.ldlt().solve(b);
      if (!change.allFinite()) continue;
      for (std::size_t i = 0; i < k_fit_count; ++i) weights_[axis][i] = change[static_cast<Eigen::Index>(i)];
      weights_[axis][0] += 1.0;
    }
  }
}

}  // namespace sightline
