#include "main_view/client/object_motion.hpp"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace sightline {
namespace {

constexpr double k_jump_m = 0.5;
constexpr double k_jump_speed_factor = 4.0;
/// Shorter steps of the centre are noise: they have no direction to speak of.
constexpr double k_least_step_m = 1e-5;
constexpr double k_fastest_bend_rad_per_s = 30.0;
/// An extrapolated turn is cut in pieces no larger than this, unless that took more than so many.
constexpr double k_piece_rad = 0.25;
constexpr int k_most_pieces_of_a_way = 24;

/// Rotation vector (axis times angle) that takes one linear part to the other; nothing for flat or mirrored
/// ones.
glm::dvec3 rotation_between(const glm::dmat3& from, const glm::dmat3& to) noexcept {
  const double volume = glm::determinant(from);
  if (!(std::abs(volume) > 1e-30)) return glm::dvec3(0.0);
  const glm::dmat3 change = to * glm::inverse(from);
  glm::dvec3 x = change[0], y = change[1];
  if (!(glm::length(x) > 1e-12) || !(glm::determinant(change) > 0.0)) return glm::dvec3(0.0);
  x = glm::normalize(x);
  y -= glm::dot(x, y) * x;
  if (!(glm::length(y) > 1e-12)) return glm::dvec3(0.0);
  y = glm::normalize(y);
  glm::dquat turn = glm::quat_cast(glm::dmat3(x, y, glm::cross(x, y)));
  if (turn.w < 0.0) turn = -turn;
  const glm::dvec3 imaginary(turn.x, turn.y, turn.z);
  const double sine = glm::length(imaginary);
  if (!(sine > 0.0)) return glm::dvec3(0.0);
  return imaginary * (2.0 * std::atan2(sine, turn.w) / sine);
}

glm::dmat3 rotation_by(const glm::dvec3& vector) noexcept {
  const double angle = glm::length(vector);
  if (!(angle > 0.0)) return glm::dmat3(1.0);
  return glm::mat3_cast(glm::angleAxis(angle, vector / angle));
}

/// How fast the direction of a velocity turns from one step to the next, the middles of which lie `between_s`
/// apart.
glm::dvec3 bend_between(const glm::dvec3& before, const glm::dvec3& after, double between_s) noexcept {
  const glm::dvec3 normal = glm::cross(before, after);
  const double sine = glm::length(normal), cosine = glm::dot(before, after);
  if (!(sine > 0.0) || !(cosine > 0.0)) return glm::dvec3(0.0);  // turning back is no bend
  const double bend = std::atan2(sine, cosine) / between_s;
  return normal / sine * std::min(bend, k_fastest_bend_rad_per_s);
}

/// Half the box around a box of half size `half` after `linear`.
glm::dvec3 half_size_after(const glm::dmat3& linear, const glm::dvec3& half) noexcept {
  return glm::abs(linear[0]) * half.x + glm::abs(linear[1]) * half.y + glm::abs(linear[2]) * half.z;
}

/// What single precision moves of the object's own shape, and double of its place.
double rounding_m(const glm::dvec3& reach, double radius) noexcept {
  return 0x1p-20 * radius + 1e-12 * std::max({reach.x, reach.y, reach.z});
}

glm::dvec3 half_size_of(const Aabb& box) noexcept {
  return box.empty() ? glm::dvec3(0.0) : 0.5 * (glm::dvec3(box.max) - glm::dvec3(box.min));
}

}  // namespace

ObjectMotion::ObjectMotion(const Aabb& object_bounds, const glm::dmat4x3& world_from_object) noexcept
    : object_bounds_(object_bounds), world_from_object_(world_from_object) {}

glm::dvec3 ObjectMotion::center_of(const glm::dmat4x3& world_from_object) const noexcept {
  const glm::dvec3 center = object_bounds_.empty()
                                ? glm::dvec3(0.0)
                                : 0.5 * (glm::dvec3(object_bounds_.min) + glm::dvec3(object_bounds_.max));
  return world_from_object * glm::dvec4(center, 1.0);
}

double ObjectMotion::radius_m() const noexcept {
  return glm::length(half_size_after(glm::dmat3(world_from_object_), half_size_of(object_bounds_)));
}

bool ObjectMotion::step(double from_s, double to_s, const glm::dmat4x3& world_from_object) noexcept {
  const glm::dvec3 way = center_of(world_from_object) - center_of(world_from_object_);
  const glm::dvec3 turn = rotation_between(glm::dmat3(world_from_object_), glm::dmat3(world_from_object));
  const double last_step_s = step_s_;
  world_from_object_ = world_from_object;
  time_s_ = to_s;
  step_s_ = to_s - from_s;
  const double way_m = glm::length(way);
  if (!(step_s_ > 1e-6) || !(way_m <= k_jump_m + k_jump_speed_factor * last_speed_m_per_s_ * step_s_)) {
    last_speed_m_per_s_ = step_s_ > 1e-6 ? way_m / step_s_ : 0.0;
    stop();
    return false;
  }
  last_speed_m_per_s_ = way_m / step_s_;
  const glm::dvec3 mean_velocity = way / step_s_;
  rotation_rad_per_s_ = turn / step_s_;
  bend_rad_per_s_ = glm::dvec3(0.0);
  if (way_m > k_least_step_m && glm::length(last_mean_velocity_m_per_s_) * last_step_s > k_least_step_m)
    bend_rad_per_s_ = bend_between(last_mean_velocity_m_per_s_, mean_velocity, 0.5 * (step_s_ + last_step_s));
  last_mean_velocity_m_per_s_ = mean_velocity;
  // The step is a chord: along the arc it went faster, and at its end it points half the step's bend further.
  const double half_bend = 0.5 * glm::length(bend_rad_per_s_) * step_s_;
  const double arc = half_bend > 1e-6 ? half_bend / std::sin(half_bend) : 1.0;
  velocity_m_per_s_ = rotation_by(0.5 * step_s_ * bend_rad_per_s_) * mean_velocity * arc;
  return true;
}

void ObjectMotion::stop() noexcept {
  velocity_m_per_s_ = bend_rad_per_s_ = rotation_rad_per_s_ = last_mean_velocity_m_per_s_ = glm::dvec3(0.0);
}

glm::dvec3 ObjectMotion::center_after(double passed_s) const noexcept {
  const double bend = glm::length(bend_rad_per_s_), angle = bend * passed_s;
  const glm::dvec3 start = center_of(world_from_object_);
  if (!(angle > 1e-6)) return start + velocity_m_per_s_ * passed_s;
  // The velocity is at right angles to the axis of its bend.
  const glm::dvec3 across = glm::cross(bend_rad_per_s_ / bend, velocity_m_per_s_);
  return start + (velocity_m_per_s_ * std::sin(angle) + across * (1.0 - std::cos(angle))) / bend;
}

WorldBox ObjectMotion::bounds() const noexcept {
  const glm::dvec3 center = center_of(world_from_object_);
  const glm::dvec3 half = half_size_after(glm::dmat3(world_from_object_), half_size_of(object_bounds_));
  return widened({center - half, center + half}, rounding_m(glm::abs(center) + half, radius_m()));
}

WorldBox ObjectMotion::bounds_between(double from_s, double to_s) const noexcept {
  const double begin_s = std::max(from_s - time_s_, 0.0), end_s = std::max(to_s - time_s_, begin_s);
  const double bend = glm::length(bend_rad_per_s_), rotation = glm::length(rotation_rad_per_s_);
  const auto pieces_of = [&](double rad_per_s) {
    return std::ceil(rad_per_s * (end_s - begin_s) / k_piece_rad);
  };
  // What turns too fast is taken for a ball.
  const bool ball = pieces_of(rotation) > k_most_pieces_of_a_way;
  const int pieces = static_cast<int>(std::clamp(std::max(pieces_of(bend), ball ? 0.0 : pieces_of(rotation)),
                                                 1.0, double{k_most_pieces_of_a_way}));
  const double piece_s = (end_s - begin_s) / pieces;
  const double radius = radius_m();
  const glm::dvec3 half = half_size_of(object_bounds_);
  const glm::dmat3 linear(world_from_object_);

  WorldBox way{glm::dvec3(INFINITY), glm::dvec3(-INFINITY)};
  for (int i = 0; i <= pieces; ++i) {
    const double passed_s = begin_s + i * piece_s;
    const glm::dvec3 center = center_after(passed_s);
    const glm::dvec3 size = ball
                                ? glm::dvec3(radius)
                                : half_size_after(rotation_by(rotation_rad_per_s_ * passed_s) * linear, half);
    way.min = glm::min(way.min, center - size);
    way.max = glm::max(way.max, center + size);
  }
  // Between two places a point leaves the straight line by what an arc rises above its chord, r a^2 / 8.
  const double rise = 0.125 * piece_s * piece_s *
                      ((ball ? 0.0 : radius * rotation * rotation) + glm::length(velocity_m_per_s_) * bend);
  const glm::dvec3 reach = glm::max(glm::abs(way.min), glm::abs(way.max));
  return widened(way, rise + rounding_m(reach, radius));
}

double ObjectMotion::speed_m_per_s() const noexcept {
  return glm::length(velocity_m_per_s_) + radius_m() * glm::length(rotation_rad_per_s_);
}

double excess_m(const WorldBox& outer, const WorldBox& inner) noexcept {
  const glm::dvec3 out = glm::max(outer.min - inner.min, inner.max - outer.max);
  return std::max({out.x, out.y, out.z, 0.0});
}

WorldBox widened(const WorldBox& box, double by_m) noexcept {
  return {box.min - by_m, box.max + by_m};
}

}  // namespace sightline
