#include "main_view/client/adaptive_predictor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sightline {
namespace {

constexpr double k_shortest_lead_s = 1.0 / 60.0;
constexpr double k_memory_s = 5.5;          // after it, an outcome counts a third
constexpr std::size_t k_solved_a_pose = 2;  // leads whose weights are renewed with each pose
constexpr std::size_t k_max_records = 2048;
constexpr double k_longest_bridge_s = 0.1;
constexpr double k_pi = 3.141592653589793;

// A stray pose: so far from the expected one, and so many times further than the poses of the last second
// were.
constexpr double k_stray_m = 0.1;
constexpr double k_stray_rad = 0.2;
constexpr double k_stray_factor = 8.0;
constexpr double k_surprise_memory_s = 1.0;
constexpr double k_stray_share = 0.25;  // of a stray's distance, to get used to: the next may come in a while
constexpr std::size_t k_least_poses_to_doubt = 3;

constexpr std::size_t k_first_poses = 3;  // with fewer, a motion's speed is hardly known

/// Between two samples: linear in position, slerp in rotation.
Pose between(const TimedPose& before, const TimedPose& after, double time_s) {
  const double u = (time_s - before.time_s) / (after.time_s - before.time_s);
  if (u > 1.0 - 1e-6) return after.pose;  // due just then, but for rounding
  return {glm::mix(before.pose.position_m, after.pose.position_m, u),
          glm::slerp(before.pose.world_from_camera, after.pose.world_from_camera, u)};
}

double squared(double value) {
  return value * value;
}

/// How much the bank's fits differ, root of the sum of squares.
LocalMotion disagreement(const BankMotions& motions) {
  LocalMotion sum{};
  for (std::size_t i = 1; i < k_fit_count; ++i) {
    for (std::size_t axis = 0; axis < k_motion_axis_count; ++axis)
      sum[axis] += motions[i][axis] * motions[i][axis];
  }
  for (double& value : sum) value = std::sqrt(value);
  return sum;
}

}  // namespace

AdaptivePredictor::AdaptivePredictor() {
  samples_.reserve(k_fit_bank_window + 1);
}

void AdaptivePredictor::forget_motion() {
  samples_.clear();
  stray_.reset();
  records_.clear();
  for (Lead& lead : leads_) lead.next = 0;
}

void AdaptivePredictor::observe(const PoseHistory& history) {
  const auto held = history.samples();
  if (held.empty()) return;
  const bool cleared =
      newest_ && (held.front().time_s > newest_->time_s || held.back().time_s < newest_->time_s);
  if (cleared) {
    forget_motion();
    newest_.reset();
  }
  for (const TimedPose& sample : held) {
    if (newest_ && sample.time_s < newest_->time_s) continue;
    if (!newest_ || sample.time_s > newest_->time_s) {
      take(sample);
    } else if (sample.pose != newest_->pose) {
      replace_newest(sample);
    }
    newest_ = sample;
  }
}

void AdaptivePredictor::replace_newest(const TimedPose& sample) {
  if (stray_) {
    stray_ = sample;
    return;
  }
  samples_.back() = sample;
  records_.pop_back();  // none of its forecasts is due
  make_record();
}

LocalMotion AdaptivePredictor::surprise_of(const TimedPose& sample) const {
  const Record& last = records_.back();
  const double step_s = sample.time_s - last.at.time_s;
  return motion_between(last.at.pose, sample.pose) - last.bank.front().at(step_s);
}

bool AdaptivePredictor::is_stray(const LocalMotion& surprise) const noexcept {
  return samples_.size() >= k_least_poses_to_doubt &&
         (translation_m(surprise) > std::max(k_stray_m, k_stray_factor * surprise_m_) ||
          turn_rad(surprise) > std::max(k_stray_rad, k_stray_factor * surprise_rad_));
}

void AdaptivePredictor::get_used_to(const LocalMotion& surprise, double share, double step_s) noexcept {
  const double keep = std::exp(-step_s / k_surprise_memory_s);
  surprise_m_ = std::max(keep * surprise_m_, share * translation_m(surprise));
  surprise_rad_ = std::max(keep * surprise_rad_, share * turn_rad(surprise));
}

void AdaptivePredictor::take(const TimedPose& sample) {
  if (samples_.empty()) {
    take_believed(sample);
    return;
  }
  const bool doubtful = is_stray(surprise_of(sample));
  if (!stray_ && doubtful) {
    stray_ = sample;
    return;
  }
  if (stray_) {
    const TimedPose stray = *stray_;
    stray_.reset();
    if (doubtful) {
      // Two in a row are no accident: the motion broke off, and goes on from there.
      forget_motion();
      take_believed(stray);
    } else {
      get_used_to(surprise_of(stray), k_stray_share, 0.0);
    }
  }
  take_believed(sample);
}

void AdaptivePredictor::take_believed(const TimedPose& sample) {
  if (!samples_.empty()) {
    judge_forecasts(samples_.back(), sample);
    get_used_to(surprise_of(sample), 1.0, sample.time_s - samples_.back().time_s);
    has_moved_ = has_moved_ || sample.pose != samples_.back().pose;
  }
  samples_.push_back(sample);
  if (samples_.size() > k_fit_bank_window) samples_.erase(samples_.begin());
  for (std::size_t i = 0; i < k_solved_a_pose; ++i) {
    leads_[next_solved_].blend.solve();
    next_solved_ = (next_solved_ + 1) % k_lead_count;
  }
  make_record();
  drop_old_records();
}

void AdaptivePredictor::judge_forecasts(const TimedPose& before, const TimedPose& now) {
  const double step_s = now.time_s - before.time_s;
  const double keep = std::exp(-step_s / k_memory_s);
  const ErrorMemory memory(step_s);
  for (std::size_t i = 0; i < k_lead_count; ++i) {
    Lead& lead = leads_[i];
    for (; lead.next < records_.size(); ++lead.next) {
      const Record& record = records_[lead.next];
      const Forecast& forecast = record.forecasts[i];
      const double due_s = record.at.time_s + forecast.lead_s;
      if (due_s > now.time_s + 1e-6 * step_s) break;
      // Where poses were lost, nobody knows what came to be in between.
      if (step_s > k_longest_bridge_s && due_s < now.time_s - 1e-6 * step_s) continue;
      const LocalMotion truth = motion_between(record.at.pose, between(before, now, due_s));
      const LocalMotion error = truth - forecast.motion;
      const double overlap = forecast.lead_s / step_s;
      // Below a nanometre and its like an error is rounding.
      Regions& regions = record.first ? lead.first_regions : lead.regions;
      regions.m.learn(translation_m(error), forecast.doubt_m, forecast.radius_m + 1e-9, memory, overlap);
      regions.rad.learn(turn_rad(error), forecast.doubt_rad, forecast.radius_rad + 1e-9, memory, overlap);
      lead.blend.learn(motions_at(record.bank, forecast.lead_s), truth, keep);
    }
  }
}

double AdaptivePredictor::pose_interval_s() const noexcept {
  if (samples_.size() < 2) return k_shortest_lead_s;
  return (samples_.back().time_s - samples_.front().time_s) / static_cast<double>(samples_.size() - 1);
}

void AdaptivePredictor::make_record() {
  Record record{samples_.back(), fit_bank(samples_), samples_.size() < k_first_poses, {}};
  const double interval_s = pose_interval_s();
  double nominal_s = k_shortest_lead_s;
  double likely_m = 0.0;
  double likely_rad = 0.0;
  for (std::size_t i = 0; i < k_lead_count; ++i, nominal_s *= std::sqrt(2.0)) {
    Forecast& forecast = record.forecasts[i];
    // Where poses are regular, one will arrive at just that time.
    forecast.lead_s = std::max(1.0, std::round(nominal_s / interval_s)) * interval_s;
    const BankMotions motions = motions_at(record.bank, forecast.lead_s);
    forecast.motion = blended(motions, leads_[i].blend.weights());
    const LocalMotion spread = disagreement(motions);
    // Errors grow with the lead, with its square at most where the motion is smooth.
    const double growth = i == 0 ? 0.0 : squared(forecast.lead_s / record.forecasts[i - 1].lead_s);
    likely_m *= growth;
    likely_rad *= growth;
    const Lead& lead = leads_[i];
    forecast.doubt_m = {translation_m(spread), translation_m(motions[0])};
    forecast.doubt_rad = {turn_rad(spread), turn_rad(motions[0])};
    announce(record, lead, likely_m, likely_rad, forecast);
    likely_m = lead.regions.m.likely_error(likely_m);
    likely_rad = lead.regions.rad.likely_error(likely_rad);
  }
  records_.push_back(record);
}

/// The forecast's radii; its motion and doubts are there already.
void AdaptivePredictor::announce(const Record& record, const Lead& lead, double likely_m, double likely_rad,
                                 Forecast& forecast) const {
  forecast.radius_m = lead.regions.m.radius(forecast.doubt_m, likely_m);
  forecast.radius_rad = lead.regions.rad.radius(forecast.doubt_rad, likely_rad);
  if (record.first) {
    forecast.radius_m = std::max(forecast.radius_m, lead.first_regions.m.radius(forecast.doubt_m, 0.0));
    forecast.radius_rad =
        std::max(forecast.radius_rad, lead.first_regions.rad.radius(forecast.doubt_rad, 0.0));
  }
  if (!has_moved_) return;
  const double half_square = 0.5 * squared(forecast.lead_s);
  forecast.radius_m = std::max(forecast.radius_m, k_start_m_per_s2 * half_square);
  forecast.radius_rad = std::max(forecast.radius_rad, k_start_turn_rad_per_s2 * half_square);
}

void AdaptivePredictor::drop_old_records() {
  std::size_t judged = records_.size();
  for (const Lead& lead : leads_) judged = std::min(judged, lead.next);
  if (records_.size() > k_max_records) judged = std::max(judged, records_.size() - k_max_records);
  records_.erase(records_.begin(), records_.begin() + static_cast<std::ptrdiff_t>(judged));
  for (Lead& lead : leads_) lead.next -= std::min(judged, lead.next);
}

PredictedPose AdaptivePredictor::predict(const PoseHistory& history, double time_s) {
  const TimedPose& newest = history.newest();
  if (!(time_s > newest.time_s)) return {newest.pose, 0.0, 0.0};
  observe(history);
  const Record& record = records_.back();
  const double lead_s = time_s - record.at.time_s;
  const Forecast forecast = forecast_at(record, lead_s);
  PredictedPose predicted{moved(record.at.pose, forecast.motion), forecast.radius_m, forecast.radius_rad};
  // A camera that stands still stays where it is, to the bit.
  if (history.still() && !stray_) predicted.pose = newest.pose;
  if (stray_) {
    const LocalMotion away = motion_between(predicted.pose, stray_->pose);
    predicted.position_error_m += translation_m(away);
    predicted.rotation_error_rad += turn_rad(away);
  }
  predicted.rotation_error_rad = std::min(predicted.rotation_error_rad, k_pi);
  return predicted;
}

AdaptivePredictor::Forecast AdaptivePredictor::forecast_at(const Record& record, double lead_s) const {
  const auto& forecasts = record.forecasts;
  // The learnt leads on either side. Below the first and beyond the last, that one.
  std::size_t upper = 0;
  while (upper + 1 < k_lead_count && forecasts[upper].lead_s < lead_s) ++upper;
  const std::size_t lower = upper == 0 ? 0 : upper - 1;
  const double low_s = forecasts[lower].lead_s;
  const double high_s = forecasts[upper].lead_s;
  const double u =
      high_s > low_s ? std::clamp(std::log(lead_s / low_s) / std::log(high_s / low_s), 0.0, 1.0) : 0.0;

  FitBlend::Weights weights;
  for (std::size_t axis = 0; axis < k_motion_axis_count; ++axis) {
    for (std::size_t i = 0; i < k_fit_count; ++i) {
      weights[axis][i] =
          (1.0 - u) * leads_[lower].blend.weights()[axis][i] + u * leads_[upper].blend.weights()[axis][i];
    }
  }
  // Further ahead than was ever learnt nothing moves on, only the doubt.
  const double last_s = forecasts.back().lead_s;
  const double growth = squared(std::max(1.0, lead_s / last_s));
  Forecast forecast;
  forecast.lead_s = lead_s;
  forecast.motion = blended(motions_at(record.bank, std::min(lead_s, last_s)), weights);
  forecast.radius_m = growth * ((1.0 - u) * forecasts[lower].radius_m + u * forecasts[upper].radius_m);
  forecast.radius_rad = growth * ((1.0 - u) * forecasts[lower].radius_rad + u * forecasts[upper].radius_rad);
  return forecast;
}

}  // namespace sightline
