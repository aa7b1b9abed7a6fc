#include "common/scene/walking_path.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/ext/scalar_constants.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

namespace sightline {
namespace {

constexpr double k_rate_hz = 60.0;
constexpr int k_sample_count = 3600;  // 60 s of the closed loop; the path repeats the first at the end
constexpr double k_eye_height_m = 1.7;
constexpr double k_sway_rad = 0.35;
constexpr double k_sway_period_s = 7.5;  // divides the duration: the loop closes
constexpr double k_look_ahead_s = 2.0;

/// Points at equal distances along the closed polygon.
std::vector<glm::dvec2> resample(std::span<const glm::dvec2> corners) {
  double length = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i)
    length += glm::distance(corners[i], corners[(i + 1) % corners.size()]);
  std::vector<glm::dvec2> points;
  points.reserve(k_sample_count);
  std::size_t edge = 0;
  double edge_start = 0.0;
  for (int i = 0; i < k_sample_count; ++i) {
    const double at = length * i / k_sample_count;
    double edge_length = glm::distance(corners[edge], corners[(edge + 1) % corners.size()]);
    while (at > edge_start + edge_length && edge + 1 < corners.size()) {
      edge_start += edge_length;
      ++edge;
      edge_length = glm::distance(corners[edge], corners[(edge + 1) % corners.size()]);
    }
    const double share = edge_length > 0.0 ? std::min(1.0, (at - edge_start) / edge_length) : 0.0;
    points.push_back(glm::mix(corners[edge], corners[(edge + 1) % corners.size()], share));
  }
  return points;
}

/// Mean over a window of samples, round the loop.
std::vector<glm::dvec2> averaged(const std::vector<glm::dvec2>& points, int window) {
  const int count = static_cast<int>(points.size());
  const auto at = [&](int i) { return points[static_cast<std::size_t>((i % count + count) % count)]; };
  std::vector<glm::dvec2> result(points.size());
  glm::dvec2 sum(0.0);
  for (int k = -window; k <= window; ++k) sum += at(k);
  for (int i = 0; i < count; ++i) {
    result[static_cast<std::size_t>(i)] = sum / (2.0 * window + 1.0);
    sum += at(i + window + 1) - at(i - window);
  }
  return result;
}

}  // namespace

CameraPath walk_round(std::span<const glm::dvec2> corners, double smoothing_s) {
  // Twice over half the time: the mean of a mean turns without a jump in angular velocity.
  const int window = std::max(1, static_cast<int>(smoothing_s * k_rate_hz / 4.0));
  const std::vector<glm::dvec2> points = averaged(averaged(resample(corners), window), window);
  const auto at = [&](int i) { return points[static_cast<std::size_t>(i % k_sample_count)]; };
  const int ahead = static_cast<int>(k_look_ahead_s * k_rate_hz);
  CameraPath path;
  for (int i = 0; i <= k_sample_count; ++i) {
    const double time_s = i / k_rate_hz;
    const glm::dvec2 way = at(i + ahead) - at(i);
    const double sway = k_sway_rad * std::sin(2.0 * glm::pi<double>() * time_s / k_sway_period_s);
    // Camera looks down -Z: a yaw of 0 walks towards -Z, of pi/2 towards -X.
    const double yaw = std::atan2(-way.x, -way.y) + sway;
    const glm::dquat rotation = glm::angleAxis(yaw, glm::dvec3(0.0, 1.0, 0.0));
    path.samples.push_back({time_s, {{at(i).x, k_eye_height_m, at(i).y}, rotation}});
  }
  return path;
}

}  // namespace sightline
