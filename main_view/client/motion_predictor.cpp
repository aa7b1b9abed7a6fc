#include "main_view/client/motion_predictor.hpp"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

constexpr double k_pi = 3.141592653589793;
constexpr std::size_t k_max_pending = 256;
constexpr std::size_t k_max_outcomes = 512;

PoseComponents components_of(const Pose& pose) {
  const auto& p = pose.position_m;
  const auto& q = pose.world_from_camera;
  return {p.x, p.y, p.z, q.w, q.x, q.y, q.z};
}

/// Between two samples: linear in position, slerp in rotation.
Pose between(const TimedPose& before, const TimedPose& after, double time_s) {
  const double u = (time_s - before.time_s) / (after.time_s - before.time_s);
  return {glm::mix(before.pose.position_m, after.pose.position_m, u),
          glm::slerp(before.pose.world_from_camera, after.pose.world_from_camera, u)};
}

}  // namespace

MotionPredictor::MotionPredictor(const CullingOptions& options)
    : order_(options.predictor_order), window_(options.predictor_window) {
  if (options.predictor == PredictorKind::adaptive) adaptive_.emplace();
}

PredictedPose MotionPredictor::predict(const PoseHistory& history, double time_s) {
  return adaptive_ ? adaptive_->predict(history, time_s) : predict_fixed(history, time_s);
}

PredictedPose MotionPredictor::predict_fixed(const PoseHistory& history, double time_s) {
  const TimedPose& newest = history.newest();
  const double lead_s = time_s - newest.time_s;
  if (!(lead_s > 0.0)) return {newest.pose, 0.0, 0.0};

  PredictedPose predicted =
      history.still() ? PredictedPose{newest.pose, 0.0, 0.0} : extrapolate(history, time_s);
  if (!history.still()) {
    for (const Outcome& outcome : outcomes_) {
      // Errors grow with the lead, at least in proportion: a shorter one's error is scaled up, a longer one's
      // kept.
      const double scale = std::max(1.0, lead_s / outcome.lead_s);
      if (scale > 2.0) continue;
      const double margin = k_memory_error_factor * scale;
      predicted.position_error_m = std::max(predicted.position_error_m, margin * outcome.position_error_m);
      predicted.rotation_error_rad =
          std::max(predicted.rotation_error_rad, margin * outcome.rotation_error_rad);
    }
  }
  predicted.rotation_error_rad = std::min(predicted.rotation_error_rad, k_pi);
  pending_.push_back({time_s, lead_s, predicted.pose});
  if (pending_.size() > k_max_pending) pending_.pop_front();
  return predicted;
}

PredictedPose MotionPredictor::extrapolate(const PoseHistory& history, double time_s) {
  const auto all = history.samples();
  const auto used = all.last(std::min(all.size(), static_cast<std::size_t>(window_)));
  times_s_.clear();
  values_.clear();
  for (const TimedPose& sample : used) {
    times_s_.push_back(sample.time_s);
    values_.push_back(components_of(sample.pose));
  }
  const int order = std::min(order_, static_cast<int>(used.size()) - 1);
  const Extrapolation fitted = fit_and_extrapolate(times_s_, values_, order, time_s);

  const auto& v = fitted.value;
  const Pose& newest = used.back().pose;
  const glm::dquat rotation(v[3], v[4], v[5], v[6]);
  const double length = glm::length(rotation);
  // A polynomial may pass through zero far ahead, where it has no direction.
  const bool usable = std::isfinite(length) && length > 1e-3;
  PredictedPose predicted{
      {{v[0], v[1], v[2]}, usable ? rotation / length : newest.world_from_camera}, 0.0, 0.0};

  if (fitted.residuals_known) {
    const auto& s = fitted.variance;
    predicted.position_error_m = k_fit_error_factor * std::sqrt(s[0] + s[1] + s[2]);
    // A small turn by an angle moves the quaternion by half of it.
    predicted.rotation_error_rad = k_fit_error_factor * 2.0 * std::sqrt(s[3] + s[4] + s[5] + s[6]);
  } else {
    // As many coefficients as samples: nothing vouches for any of the way.
    predicted.position_error_m = glm::length(predicted.pose.position_m - newest.position_m);
    predicted.rotation_error_rad =
        rotation_angle_rad(predicted.pose.world_from_camera, newest.world_from_camera);
  }
  if (!usable) predicted.rotation_error_rad = k_pi;
  return predicted;
}

void MotionPredictor::observe(const PoseHistory& history) {
  if (adaptive_) {
    adaptive_->observe(history);
    return;
  }
  const auto samples = history.samples();
  if (samples.empty()) return;
  const double now_s = samples.back().time_s;
  while (!outcomes_.empty() &&
         (outcomes_.front().time_s < now_s - k_error_memory_s || outcomes_.size() > k_max_outcomes)) {
    outcomes_.pop_front();
  }
  // Not sorted when the horizon shrinks, so look at all of them.
  std::erase_if(pending_, [&](const Pending& prediction) {
    if (prediction.time_s > now_s) return false;
    const auto after = std::find_if(samples.begin(), samples.end(), [&](const TimedPose& sample) {
      return sample.time_s >= prediction.time_s;
    });
    if (after == samples.begin() && after->time_s > prediction.time_s) return true;  // before all we remember
    const Pose truth = after->time_s == prediction.time_s
                           ? after->pose
                           : between(*std::prev(after), *after, prediction.time_s);
    outcomes_.push_back({now_s, prediction.lead_s, glm::length(truth.position_m - prediction.pose.position_m),
                         rotation_angle_rad(truth.world_from_camera, prediction.pose.world_from_camera)});
    return true;
  });
}

}  // namespace sightline
