#pragma once

#include <array>
#include <cstddef>

#include "main_view/client/fit_bank.hpp"
#include "main_view/client/local_motion.hpp"

namespace sightline {

/// What each fit says of one lead: the first its movement, the others how theirs differ from it.
using BankMotions = std::array<LocalMotion, k_fit_count>;
[[nodiscard]] BankMotions motions_at(const FitBank& bank, double lead_s) noexcept;

/// How much of each fit to believe, learnt from how the fits did: for each of the six axes the weights with
/// the smallest sum of squared errors, older ones discounted. Weights below 1 in sum are damping: a head that
/// is turning will have slowed down.
///
/// Least squares in its recursive form (normal equations; L. Ljung, "System Identification", 1987, ch. 11),
/// the combination of forecasts by J. M. Bates and C. W. J. Granger, "The Combination of Forecasts", 1969.
/// Ours: the axes of a kind (three of translation, three of turn) share a little of what they learn, and the
/// weights are drawn to the first fit alone, as far as the evidence is thin.
class FitBlend {
 public:
  using Weights = std::array<std::array<double, k_fit_count>, k_motion_axis_count>;

  FitBlend() noexcept;

  /// The fits said `motions`, and it came to be `truth`. What was learnt before counts `keep` times (0 to 1).
  void learn(const BankMotions& motions, const LocalMotion& truth, double keep) noexcept;
  /// Brings the weights up to date with what was learnt: the costly part.
  void solve();

  [[nodiscard]] const Weights& weights() const noexcept { return weights_; }
  /// Outcomes learnt from, discounted.
  [[nodiscard]] double evidence() const noexcept { return evidence_; }

 private:
  /// Sums over outcomes, of one axis: A = sum of m m^T, the lower half (column after column), and
  /// b = sum of m (truth - m[0]).
  struct Normal {
    std::array<double, k_fit_count * k_fit_count> a{};
    std::array<double, k_fit_count> b{};
  };

  std::array<Normal, k_motion_axis_count> normal_;
  Weights weights_;
  double evidence_ = 0.0;
};

[[nodiscard]] LocalMotion blended(const BankMotions& motions, const FitBlend::Weights& weights) noexcept;

}  // namespace sightline
