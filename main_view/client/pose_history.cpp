#include "main_view/client/pose_history.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "common/error.hpp"

namespace sightline {
namespace {

void require_usable(const TimedPose& sample) {
  const auto& p = sample.pose.position_m;
  const auto& q = sample.pose.world_from_camera;
  const double length = glm::dot(q, q);
  const bool finite = std::isfinite(sample.time_s) && std::isfinite(p.x) && std::isfinite(p.y) &&
                      std::isfinite(p.z) && std::isfinite(length);
  if (finite && length > 1e-12) return;
  throw InputError("camera pose at " + std::to_string(sample.time_s) +
                   " s is not usable: give finite numbers and a quaternion that is not zero");
}

}  // namespace

PoseHistory::PoseHistory(const CullingOptions& options)
    : options_(options), limit_(static_cast<std::size_t>(std::max(options.predictor_window, 2))) {
  samples_.reserve(limit_ + 1);
}

PoseHistory::Added PoseHistory::add(const TimedPose& sample) {
  require_usable(sample);
  if (!samples_.empty() && sample.time_s < newest_as_given_.time_s) return Added::ignored;

  const auto velocity_to = [&](const TimedPose& from) {
    return (sample.pose.position_m - from.pose.position_m) / (sample.time_s - from.time_s);
  };
  const bool replaces = !samples_.empty() && sample.time_s - samples_.back().time_s < k_least_step_s;
  const bool later = !samples_.empty() && !replaces;
  const glm::dvec3 velocity = later ? velocity_to(samples_.back()) : last_velocity_m_per_s_;

  TimedPose held = sample;
  if (replaces) held.time_s = samples_.back().time_s;
  held.pose.world_from_camera = glm::normalize(sample.pose.world_from_camera);
  Added result = Added::continued;
  if (samples_.empty()) {
    result = Added::restarted;
  } else if (is_jump(samples_.back(), held)) {
    result = Added::jumped;
    samples_.clear();
  } else if (held.time_s - samples_.back().time_s > options_.pose_gap_s) {
    result = Added::restarted;
    samples_.clear();
  } else if (replaces) {
    samples_.pop_back();
  }

  if (!samples_.empty() &&
      glm::dot(samples_.back().pose.world_from_camera, held.pose.world_from_camera) < 0.0) {
    held.pose.world_from_camera = -held.pose.world_from_camera;
  }
  last_velocity_m_per_s_ = velocity;
  samples_.push_back(held);
  if (samples_.size() > limit_) samples_.erase(samples_.begin());
  newest_as_given_ = sample;
  return result;
}

bool PoseHistory::is_jump(const TimedPose& from, const TimedPose& to) const noexcept {
  const double dt_s = to.time_s - from.time_s;
  const double turned_rad = rotation_angle_rad(from.pose.world_from_camera, to.pose.world_from_camera);
  if (turned_rad > options_.jump_rotation_rad + options_.jump_turn_speed_rad_per_s * dt_s) return true;

  const glm::dvec3 step_m = to.pose.position_m - from.pose.position_m;
  const double explained_m = options_.jump_speed_factor * speed_m_per_s() * dt_s;
  if (glm::length(step_m) <= options_.jump_distance_m + explained_m) return false;
  // Right after a jump no speed is known. A fast drive repeats its step, a second teleport does not.
  const glm::dvec3 expected_m = last_velocity_m_per_s_ * dt_s;
  return glm::length(step_m - expected_m) > options_.jump_distance_m + 0.5 * glm::length(expected_m);
}

bool PoseHistory::still() const noexcept {
  return std::all_of(samples_.begin(), samples_.end(),
                     [this](const TimedPose& sample) { return sample.pose == samples_.back().pose; });
}

double PoseHistory::speed_m_per_s() const noexcept {
  double speed = 0.0;
  for (std::size_t i = 1; i < samples_.size(); ++i) {
    const double dt_s = samples_[i].time_s - samples_[i - 1].time_s;
    speed =
        std::max(speed, glm::length(samples_[i].pose.position_m - samples_[i - 1].pose.position_m) / dt_s);
  }
  return speed;
}

double PoseHistory::turn_speed_rad_per_s() const noexcept {
  double speed = 0.0;
  for (std::size_t i = 1; i < samples_.size(); ++i) {
    const double dt_s = samples_[i].time_s - samples_[i - 1].time_s;
    speed = std::max(speed, rotation_angle_rad(samples_[i - 1].pose.world_from_camera,
                                               samples_[i].pose.world_from_camera) /
                                dt_s);
  }
  return speed;
}

}  // namespace sightline
