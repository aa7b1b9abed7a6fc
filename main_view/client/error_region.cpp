#include "main_view/client/error_region.hpp"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

constexpr double k_recent_s = 3.0;
constexpr double k_longer_s = 15.0;
constexpr double k_peak_s = 1.0;
constexpr double k_worst_s = 200.0;
constexpr double k_few_outcomes = 30.0;

// How much of each makes up the scale. Tuned on half of the recorded traces, with the other half in view.
constexpr double k_recent_share = 0.5;
constexpr double k_longer_share = 0.5;
constexpr double k_peak_share = 0.2;
// So much more with a doubt as usual, and up to k_most_doubt times as much with one above.
constexpr double k_disagreement_share = 0.2;
constexpr double k_way_share = 0.3;
constexpr double k_most_doubt = 5.0;
// Of the doubt itself, before there was any outcome.
constexpr double k_first_disagreement_share = 0.25;
constexpr double k_first_way_share = 0.05;

// The most: so many times the worst error; more while few leads have gone by, for a worse one may be to come.
constexpr double k_most_of_worst = 1.5;
constexpr double k_most_of_worst_at_first = 100.0;

constexpr double k_factor_step = 0.2;
constexpr double k_overlap_power = -0.5;
// A long calm or a long storm must not carry the factor to where it takes minutes to return from.
constexpr double k_least_log_factor = -0.7;
constexpr double k_most_log_factor = 3.0;

/// Against the usual, given as a mean square.
double relative(double doubt, double usual_square) {
  return usual_square > 0.0 ? std::min(doubt / std::sqrt(usual_square), k_most_doubt) : 0.0;
}

}  // namespace

ErrorMemory::ErrorMemory(double step_s) noexcept
    : recent(std::exp(-step_s / k_recent_s)),
      longer(std::exp(-step_s / k_longer_s)),
      peak(std::exp(-step_s / k_peak_s)),
      worst(std::exp(-step_s / k_worst_s)) {}

void ErrorRegion::learn(double error, const ForecastDoubt& doubt, double announced, const ErrorMemory& memory,
                        double overlap) noexcept {
  outcome_count_ += 1.0;
  overlap_ = std::max(1.0, overlap);
  const double recent = std::max(1.0 - memory.recent, 1.0 / outcome_count_);
  const double longer = std::max(1.0 - memory.longer, 1.0 / outcome_count_);
  recent_square_ += recent * (error * error - recent_square_);
  longer_square_ += longer * (error * error - longer_square_);
  disagreement_square_ += longer * (doubt.disagreement * doubt.disagreement - disagreement_square_);
  way_square_ += longer * (doubt.way * doubt.way - way_square_);
  peak_ = std::max(error, peak_ * memory.peak);
  worst_ = std::max(error, worst_ * memory.worst);
  const double step = k_factor_step * std::pow(overlap_, k_overlap_power);
  log_factor_ += step * (error > announced ? 1.0 - k_missed : -k_missed);
  log_factor_ = std::clamp(log_factor_, k_least_log_factor, k_most_log_factor);
}

double ErrorRegion::likely_error(double least) const noexcept {
  const double own = k_recent_share * std::sqrt(recent_square_) + k_longer_share * std::sqrt(longer_square_) +
                     k_peak_share * peak_;
  return outcome_count_ < k_few_outcomes ? std::max(own, least) : own;
}

double ErrorRegion::scale(const ForecastDoubt& doubt, double least) const noexcept {
  const double likely = likely_error(least);
  if (outcome_count_ == 0.0) {
    return likely + k_first_disagreement_share * doubt.disagreement + k_first_way_share * doubt.way;
  }
  return likely * (1.0 + k_disagreement_share * relative(doubt.disagreement, disagreement_square_) +
                   k_way_share * relative(doubt.way, way_square_));
}

double ErrorRegion::radius(const ForecastDoubt& doubt, double least) const noexcept {
  const double radius = std::exp(log_factor_) * scale(doubt, least);
  if (outcome_count_ == 0.0) return radius;
  const double most = k_most_of_worst + k_most_of_worst_at_first * overlap_ / outcome_count_;
  return std::min(radius, most * std::max(worst_, outcome_count_ < k_few_outcomes ? least : 0.0));
}

}  // namespace sightline
