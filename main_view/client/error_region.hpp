#pragma once

#include <array>

namespace sightline {

/// What goes with one prediction's error: how much the fits that it was blended from differ, and how far the
/// quickest of them moves.
struct ForecastDoubt {
  double disagreement = 0.0;
  double way = 0.0;
};

/// What a step of time leaves of what was learnt before it; worked out once for all regions.
struct ErrorMemory {
  explicit ErrorMemory(double step_s) noexcept;
  double recent, longer, peak, worst;  ///< shares, 0 to 1
};

/// How far off predictions at one lead may be, learnt from how far off they were. One kind of error: metres,
/// or radians.
///
/// The radius is a scale times a factor. The scale is made of the errors' root mean squares over 3 s and
/// over 15 s and their peak of the last second, more of it where this prediction's doubt is above the usual.
/// The factor follows the misses: each one raises it, each hit lowers it a little, to where k_missed of the
/// outcomes lie outside: adaptive conformal inference, I. Gibbs, E. Candès, "Adaptive Conformal Inference
/// Under Distribution Shift", 2021, here on the factor's logarithm. Ours: misses come in bursts as long as
/// the lead, so each counts less where leads overlap more; and the radius never exceeds a multiple of the
/// worst error of the last minutes, lest a burst widen it for minutes. These two, and the factor's own
/// limits, cost the method its guarantee.
///
/// It errs either way: a sudden turn is in no data before it. One surprise is missed for as long as the lead;
/// so far ahead, in a short session, the share of misses is larger.
class ErrorRegion {
 public:
  static constexpr double k_missed = 0.001;

  /// An outcome: the prediction was `error` off, with this doubt and the radius announced for it. `overlap`:
  /// how many outcomes fall into one lead; errors that near one another are alike.
  void learn(double error, const ForecastDoubt& doubt, double announced, const ErrorMemory& memory,
             double overlap) noexcept;

  /// Radius for a prediction with this doubt. `least` is what the errors so far should amount to at least,
  /// for a lead that has few outcomes of its own yet: see likely_error.
  [[nodiscard]] double radius(const ForecastDoubt& doubt, double least) const noexcept;

  /// The errors so far, before doubt and factor; at least `least` while they are few.
  [[nodiscard]] double likely_error(double least) const noexcept;

 private:
  [[nodiscard]] double scale(const ForecastDoubt& doubt, double least) const noexcept;

  double outcome_count_ = 0.0;
  double disagreement_square_ = 0.0;  ///< means of the doubts' squares
  double way_square_ = 0.0;
  double recent_square_ = 0.0;
  double longer_square_ = 0.0;
  double peak_ = 0.0;
  double worst_ = 0.0;
  double overlap_ = 1.0;
  double log_factor_ = k_first_log_factor;

  static constexpr double k_first_log_factor = 0.79;  ///< of 2.2
};

}  // namespace sightline
