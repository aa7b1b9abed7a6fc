#include "main_view/app/head_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "common/error.hpp"

namespace sightline {
namespace {

constexpr double k_longest_gap_s = 0.1;

double length_s(const CameraPath& piece) {
  return piece.samples.back().time_s - piece.samples.front().time_s;
}

CameraPath longest_piece(const CameraPath& recorded) {
  std::vector<CameraPath> pieces = pieces_between_gaps(recorded, k_longest_gap_s);
  return std::move(
      *std::max_element(pieces.begin(), pieces.end(),
                        [](const CameraPath& a, const CameraPath& b) { return length_s(a) < length_s(b); }));
}

CameraPath read_rotations(const std::filesystem::path& file) {
  CameraPath piece = longest_piece(read_camera_path(file));
  if (!(length_s(piece) > 0.0)) {
    throw InputError("--rotations: " + file.string() +
                     ": no two samples are within 0.1 s of each other; give a denser recording");
  }
  return piece;
}

/// There and back again: where a point is that runs from 0 to `length` and back, for ever.
double folded(double value, double length) {
  if (!(length > 0.0)) return 0.0;
  const double phase = std::fmod(value, 2.0 * length);
  return phase <= length ? phase : 2.0 * length - phase;
}

}  // namespace

void HeadMotionOptions::validate() const {
  const bool usable = (turn_deg_per_s >= 0.0 && turn_deg_per_s <= HeadMotion::k_fastest_deg_per_s) ||
                      turn_deg_per_s == std::numeric_limits<double>::infinity();
  if (!usable) throw InputError("--turn: give 0 to 1500 degrees a second, or inf for turns in no time");
}

HeadMotion::HeadMotion(const HeadMotionOptions& options)
    : HeadMotion(options.rotations.empty() ? std::nullopt : std::optional(read_rotations(options.rotations)),
                 options.turn_deg_per_s) {}

HeadMotion::HeadMotion(std::optional<CameraPath> recorded, double turn_deg_per_s)
    : recorded_(std::move(recorded)), turn_deg_per_s_(turn_deg_per_s) {
  if (recorded_) recorded_ = longest_piece(*recorded_);
}

double HeadMotion::turned_rad(double elapsed_s) const {
  constexpr double k_half_circle_rad = std::numbers::pi;
  const double speed_rad_per_s = turn_deg_per_s_ * std::numbers::pi / 180.0;
  // A trapezoid of speed: the ramps cover what k_ramp_s at full speed would.
  const double turning_s = std::isinf(turn_deg_per_s_) ? 0.0 : k_half_circle_rad / speed_rad_per_s + k_ramp_s;
  const double period_s = k_still_s + turning_s;
  const double turns = std::floor(elapsed_s / period_s);
  const double turning_for_s = elapsed_s - turns * period_s - k_still_s;
  if (turning_for_s <= 0.0) return turns * k_half_circle_rad;
  const double up_s = std::min(turning_for_s, k_ramp_s);
  const double down_s = std::max(turning_for_s - (turning_s - k_ramp_s), 0.0);
  const double full_speed_s = std::max(std::min(turning_for_s, turning_s - k_ramp_s) - k_ramp_s, 0.0);
  const double ramps_s = up_s * up_s / (2.0 * k_ramp_s) + down_s - down_s * down_s / (2.0 * k_ramp_s);
  return turns * k_half_circle_rad + speed_rad_per_s * (full_speed_s + ramps_s);
}

Pose HeadMotion::applied_to(const Pose& pose, double elapsed_s) const {
  Pose turned = pose;
  if (recorded_) {
    const double start_s = recorded_->samples.front().time_s;
    const Pose then = recorded_->at(start_s + folded(elapsed_s, length_s(*recorded_)));
    const glm::dquat first_from_then =
        glm::conjugate(recorded_->samples.front().pose.world_from_camera) * then.world_from_camera;
    turned.world_from_camera = glm::normalize(turned.world_from_camera * first_from_then);
  }
  if (turn_deg_per_s_ != 0.0) {
    const glm::dquat yaw = glm::angleAxis(turned_rad(elapsed_s), glm::dvec3(0.0, 1.0, 0.0));
    turned.world_from_camera = glm::normalize(yaw * turned.world_from_camera);
  }
  return turned;
}

}  // namespace sightline
