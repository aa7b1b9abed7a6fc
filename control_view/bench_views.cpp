#include "control_view/bench_views.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <glm/gtc/constants.hpp>
#include <glm/gtc/quaternion.hpp>

#include "common/error.hpp"

namespace sightline {
namespace {

constexpr std::array<std::string_view, 4> k_names{"single", "stereo", "around", "region"};
constexpr double k_eye_separation_m = 0.064;
constexpr double k_region_radius_m = 0.1;
/// More than four hours at 60 views a second.
constexpr double k_most_bench_views = 1'000'000;

double aspect_of(ImageSize size) {
  return static_cast<double>(size.width) / static_cast<double>(size.height);
}

/// Ahead, left, behind, right, up, down.
std::vector<Pose> cube_faces(const Pose& pose) {
  std::vector<Pose> faces;
  faces.reserve(6);
  const double quarter = glm::half_pi<double>();
  for (int turn = 0; turn < 4; ++turn) {
    faces.push_back(
        {pose.position_m, pose.world_from_camera * glm::angleAxis(turn * quarter, glm::dvec3(0, 1, 0))});
  }
  for (const double tilt_rad : {quarter, -quarter}) {
    faces.push_back(
        {pose.position_m, pose.world_from_camera * glm::angleAxis(tilt_rad, glm::dvec3(1, 0, 0))});
  }
  return faces;
}

std::vector<Pose> region_samples(const Pose& pose) {
  std::vector<Pose> samples{pose};
  for (const glm::dvec3& offset :
       {glm::dvec3(1, 0, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, -1, 0)}) {
    samples.push_back(
        {pose.position_m + pose.world_from_camera * (offset * k_region_radius_m), pose.world_from_camera});
  }
  return samples;
}

}  // namespace

BenchViews parse_bench_views(std::string_view text) {
  const auto found = std::find(k_names.begin(), k_names.end(), text);
  if (found == k_names.end()) {
    throw InputError("--views must be single, stereo, around or region, not '" + std::string(text) + "'");
  }
  return static_cast<BenchViews>(found - k_names.begin());
}

std::string_view name_of(BenchViews views) noexcept {
  return k_names[static_cast<std::size_t>(views)];
}

BenchQuery bench_query(BenchViews views, const Pose& pose, ImageSize size) {
  BenchQuery query{{}, size};
  std::vector<Pose> poses{pose};
  Perspective projection;
  if (views == BenchViews::stereo) {
    const StereoEyes eyes = stereo_eyes(pose, k_eye_separation_m);
    poses = {eyes.left, eyes.right};
  } else if (views == BenchViews::around) {
    poses = cube_faces(pose);
    projection.vertical_fov_rad = glm::half_pi<double>();
    query.size = {size.height, size.height};
  } else if (views == BenchViews::region) {
    poses = region_samples(pose);
  }
  const glm::dmat4 clip = clip_from_camera(projection, aspect_of(query.size));
  for (const Pose& eye : poses) query.eyes.push_back({camera_from_world(eye), clip});
  return query;
}

std::vector<double> bench_times(const CameraPath& path, const BenchOptions& options) {
  if (path.samples.front().time_s < 0.0) throw InputError(options.path + ": its times must not be below 0");
  const double left_s = path.duration_s() - options.start_s;
  if (left_s < 0.0) {
    throw InputError("--start " + std::to_string(options.start_s) + ": " + options.path + " ends at " +
                     std::to_string(path.duration_s()) + " s");
  }
  // The small addition keeps a duration that is a whole number of frames from losing the last to rounding.
  const double on_path = std::floor(left_s * options.rate_hz / options.step + 1e-6) + 1.0;
  const double wanted = options.frames == 0 ? on_path : std::min<double>(options.frames, on_path);
  if (wanted > k_most_bench_views) {
    throw InputError(options.path + ": more than " + std::to_string(static_cast<long>(k_most_bench_views)) +
                     " views; give fewer with --frames or --step, or a lower --rate");
  }
  std::vector<double> times_s(static_cast<std::size_t>(wanted));
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    times_s[i] = options.start_s + static_cast<double>(i) * options.step / options.rate_hz;
  }
  return times_s;
}

}  // namespace sightline
