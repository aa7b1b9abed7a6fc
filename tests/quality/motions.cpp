#include "tests/quality/motions.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include <glm/gtc/quaternion.hpp>

namespace sightline::testing {
namespace {

const double k_degree = std::acos(-1.0) / 180.0;

glm::dquat turned(double yaw_deg, double pitch_deg) {
  return glm::angleAxis(yaw_deg * k_degree, glm::dvec3(0, 1, 0)) *
         glm::angleAxis(pitch_deg * k_degree, glm::dvec3(1, 0, 0));
}

}  // namespace

Pose looking(const glm::dvec3& from, double yaw_deg, double pitch_deg) {
  return {from, turned(yaw_deg, pitch_deg)};
}

Motion walk(const glm::dvec3& from, const glm::dvec3& to, double speed_m_per_s, double yaw_deg) {
  const double duration_s = glm::length(to - from) / speed_m_per_s;
  return [=](double t) { return looking(glm::mix(from, to, std::min(t / duration_s, 1.0)), yaw_deg); };
}

Motion with_head(Motion motion) {
  return [motion = std::move(motion)](double t) {
    Pose pose = motion(t);
    pose.position_m.y += 0.02 * std::sin(12.6 * t);
    pose.world_from_camera =
        pose.world_from_camera * turned(4.0 * std::sin(3.1 * t), 2.0 * std::sin(4.7 * t));
    return pose;
  };
}

Motion with_noise(Motion motion) {
  return [motion = std::move(motion)](double t) {
    std::mt19937 random(static_cast<unsigned>(std::lround(t * 60.0)) + 1);
    std::normal_distribution<double> unit;
    Pose pose = motion(t);
    pose.position_m += 0.001 * glm::dvec3(unit(random), unit(random), unit(random));
    pose.world_from_camera = pose.world_from_camera * turned(0.1 * unit(random), 0.1 * unit(random));
    return pose;
  };
}

Motion spin(const glm::dvec3& at, double deg_per_s) {
  return [=](double t) { return looking(at, deg_per_s * std::max(t - 1.0, 0.0)); };
}

Motion glances(const glm::dvec3& at, double step_deg) {
  return [=](double t) { return looking(at, step_deg * std::floor(t + 1e-9)); };
}

Motion orbit(double radius_m, double height_m, double speed_m_per_s) {
  return [=](double t) {
    const double angle = speed_m_per_s / radius_m * t;
    const glm::dvec3 at(radius_m * std::sin(angle), height_m, radius_m * std::cos(angle));
    return looking(at, angle / k_degree);
  };
}

Motion moved(Motion motion, const glm::dvec3& offset_m) {
  return [motion = std::move(motion), offset_m](double t) {
    Pose pose = motion(t);
    pose.position_m += offset_m;
    return pose;
  };
}

}  // namespace sightline::testing
