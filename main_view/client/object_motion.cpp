#include "main_view/client/object_motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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
constexpr double k_least_way_m = 1e-5;
constexpr double k_fastest_bend_rad_per_s = 30.0;
/// An extrapolated turn is cut in pieces no larger than this, unless that took more than so many.
constexpr double k_piece_rad = 0.25;
constexpr int k_most_pieces_of_a_way = 24;
/// A turn up to this is taken for straight ways: the box is then larger by 4 percent of the radius at most.
constexpr double k_little_turn_rad = 0.25;

/// Below this square of an angle the series serve.
constexpr double k_small_angle_squared = 0.25;

/// sin(a) / a of a squared angle; the series is good to 1e-13.
double sine_over_angle(double squared) noexcept {
  if (!(squared < k_small_angle_squared)) return std::sin(std::sqrt(squared)) / std::sqrt(squared);
  return 1.0 + squared * (-1.0 / 6 +
                          squared * (1.0 / 120 + squared * (-1.0 / 5040 +
                                                            squared * (1.0 / 362880 - squared / 39916800))));
}

/// (1 - cos(a)) / a^2 likewise.
double versine_over_square(double squared) noexcept {
  if (!(squared < k_small_angle_squared)) return (1.0 - std::cos(std::sqrt(squared))) / squared;
  return 0.5 + squared * (-1.0 / 24 +
                          squared * (1.0 / 720 + squared * (-1.0 / 40320 + squared * (1.0 / 3628800 -
                                                                                      squared / 479001600))));
}

/// a / sin(a) of an angle below a right one, given its sine squared and cosine, both of any length times the
/// same; over that length.
double angle_over_sine(double sine_squared, double cosine) noexcept {
  const double squared = sine_squared / (cosine * cosine);  // of the tangent
  if (!(squared < 0.04)) return std::atan2(std::sqrt(sine_squared), cosine) / std::sqrt(sine_squared);
  return (1.0 +
          squared * (-1.0 / 3 +
                     squared * (1.0 / 5 +
                                squared * (-1.0 / 7 +
                                           squared * (1.0 / 9 + squared * (-1.0 / 11 + squared / 13)))))) /
         cosine;
}

/// Rotation vector (axis times angle) of a rotation by a right angle or more, or of nearly none.
glm::dvec3 vector_of(const glm::dmat3& rotation) noexcept {
  glm::dquat turn = glm::quat_cast(rotation);
  if (turn.w < 0.0) turn = -turn;
  const glm::dvec3 imaginary(turn.x, turn.y, turn.z);
  const double sine = glm::length(imaginary);
  if (!(sine > 0.0)) return glm::dvec3(0.0);
  return imaginary * (2.0 * std::atan2(sine, turn.w) / sine);
}

/// Rotation vector that takes one linear part to the other; nothing for flat or mirrored ones.
glm::dvec3 rotation_between(const glm::dmat3& from, const glm::dmat3& to) noexcept {
  if (from == to) return glm::dvec3(0.0);
  const glm::dvec3 rows[] = {glm::cross(from[1], from[2]), glm::cross(from[2], from[0]),
                             glm::cross(from[0], from[1])};  // of the inverse, times the volume
  const double volume = glm::dot(from[0], rows[0]);
  if (!(std::abs(volume) > 1e-30)) return glm::dvec3(0.0);
  const auto column = [&](int axis) {  // of the change
    return (to[0] * rows[0][axis] + to[1] * rows[1][axis] + to[2] * rows[2][axis]) / volume;
  };
  glm::dvec3 x = column(0), y = column(1);
  const double x_length = glm::length(x);
  if (!(x_length > 1e-12)) return glm::dvec3(0.0);
  x /= x_length;
  y -= glm::dot(x, y) * x;
  const double y_length = glm::length(y);
  if (!(y_length > 1e-12)) return glm::dvec3(0.0);
  y /= y_length;
  const glm::dvec3 z = glm::cross(x, y);
  if (!(glm::dot(z, column(2)) > 0.0)) return glm::dvec3(0.0);
  const double cosine = 0.5 * (x.x + y.y + z.z - 1.0);
  if (!(cosine > 0.1)) return vector_of(glm::dmat3(x, y, z));
  const glm::dvec3 sine = 0.5 * glm::dvec3(y.z - z.y, z.x - x.z, x.y - y.x);  // times the axis
  return sine * angle_over_sine(glm::dot(sine, sine), cosine);
}

/// A vector turned by a rotation vector (Rodrigues).
glm::dvec3 turned(const glm::dvec3& v, const glm::dvec3& by, double sinc, double versinc) noexcept {
  const glm::dvec3 across = glm::cross(by, v);
  return v + sinc * across + versinc * glm::cross(by, across);
}

glm::dmat3 turned(const glm::dmat3& linear, const glm::dvec3& by) noexcept {
  const double squared = glm::dot(by, by);
  const double sinc = sine_over_angle(squared), versinc = versine_over_square(squared);
  return {turned(linear[0], by, sinc, versinc), turned(linear[1], by, sinc, versinc),
          turned(linear[2], by, sinc, versinc)};
}

/// How fast the direction of a velocity turns from one step to the next, the middles of which lie `between_s`
/// apart.
glm::dvec3 bend_between(const glm::dvec3& before, const glm::dvec3& after, double between_s) noexcept {
  const glm::dvec3 normal = glm::cross(before, after);
  const double sine_squared = glm::dot(normal, normal), cosine = glm::dot(before, after);
  if (!(sine_squared > 0.0) || !(cosine > 0.0)) return glm::dvec3(0.0);  // turning back is no bend
  const glm::dvec3 bend = normal * (angle_over_sine(sine_squared, cosine) / between_s);
  const double too_fast = glm::dot(bend, bend) / (k_fastest_bend_rad_per_s * k_fastest_bend_rad_per_s);
  return too_fast > 1.0 ? bend / std::sqrt(too_fast) : bend;
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

/// The way of a centre that goes round. The velocity is at right angles to the axis of its bend.
class Arc {
 public:
  /// After a step with this mean velocity. That was a chord: along the arc it went faster, and at its end it
  /// points half the step's bend further.
  Arc(const glm::dvec3& start, const glm::dvec3& mean_velocity, const glm::dvec3& bend,
      double step_s) noexcept
      : start_(start), bend_squared_(glm::dot(bend, bend)) {
    const glm::dvec3 half_bend = 0.5 * step_s * bend;
    const double squared = glm::dot(half_bend, half_bend);
    const double along = (1.0 - squared * versine_over_square(squared)) / sine_over_angle(squared);
    velocity_ = along * mean_velocity + glm::cross(half_bend, mean_velocity);
    across_ = glm::cross(bend, velocity_);
  }

  [[nodiscard]] glm::dvec3 after(double passed_s) const noexcept {
    const double squared = bend_squared_ * passed_s * passed_s;
    return start_ + velocity_ * (passed_s * sine_over_angle(squared)) +
           across_ * (passed_s * passed_s * versine_over_square(squared));
  }
  [[nodiscard]] double acceleration() const noexcept { return glm::length(across_); }

 private:
  glm::dvec3 start_, velocity_{0.0}, across_{0.0};
  double bend_squared_;
};

}  // namespace

ObjectMotion::ObjectMotion(const Aabb& object_bounds, const glm::dmat4x3& world_from_object) noexcept
    : ObjectMotion(object_bounds, world_from_object, Course()) {}

ObjectMotion::ObjectMotion(const Aabb& object_bounds, const glm::dmat4x3& world_from_object,
                           const Course& course) noexcept
    : object_bounds_(object_bounds), world_from_object_(world_from_object), course_(course) {
  measure();
}

void ObjectMotion::measure() noexcept {
  const glm::dvec3 center = object_bounds_.empty()
                                ? glm::dvec3(0.0)
                                : 0.5 * (glm::dvec3(object_bounds_.min) + glm::dvec3(object_bounds_.max));
  center_m_ = world_from_object_ * glm::dvec4(center, 1.0);
  half_size_m_ = half_size_after(glm::dmat3(world_from_object_), half_size_of(object_bounds_));
  radius_m_ = glm::length(half_size_m_);
}

void ObjectMotion::set_object_bounds(const Aabb& object_bounds) noexcept {
  if (object_bounds == object_bounds_) return;
  object_bounds_ = object_bounds;
  measure();
}

void ObjectMotion::place(const glm::dmat4x3& world_from_object) noexcept {
  world_from_object_ = world_from_object;
  measure();
  stop();
}

bool ObjectMotion::step(double from_s, double to_s, const glm::dmat4x3& world_from_object) noexcept {
  const glm::dmat3 linear_before(world_from_object_);
  const glm::dvec3 center_before = center_m_;
  world_from_object_ = world_from_object;
  measure();
  const glm::dvec3 way = center_m_ - center_before;
  const double way_m = glm::length(way);
  const double last_way_m = std::exchange(course_.last_way_m, way_m);
  const double last_step_s = std::exchange(course_.step_s, to_s - from_s);
  course_.time_s = to_s;
  if (is_jump(way_m, course_.step_s, last_way_m, last_step_s)) {
    stop();
    return false;
  }
  const double per_s = 1.0 / course_.step_s;
  const glm::dvec3 before = std::exchange(course_.velocity_m_per_s, way * per_s);
  const bool both_have_directions = way_m > k_least_way_m && last_way_m > k_least_way_m;
  course_.velocity_before_m_per_s = both_have_directions ? before : glm::dvec3(0.0);
  course_.between_s = 0.5 * (course_.step_s + last_step_s);
  course_.linear_per_s = (glm::dmat3(world_from_object) - linear_before) * per_s;
  return true;
}

void ObjectMotion::stop() noexcept {
  course_.velocity_m_per_s = course_.velocity_before_m_per_s = glm::dvec3(0.0);
  course_.linear_per_s = glm::dmat3(0.0);
}

/// Square of how fast it turns: a column at right angles to the axis says it, and of three at right angles to
/// each other one is nearly so (the sum of the squared sines is 2).
double ObjectMotion::turn_squared() const noexcept {
  double fastest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double change = glm::dot(course_.linear_per_s[axis], course_.linear_per_s[axis]);
    const double length = glm::dot(world_from_object_[axis], world_from_object_[axis]);
    if (change > fastest * length) fastest = change / length;
  }
  return 1.51 * fastest;  // 1.5, and the last step was a chord of the turn
}

WorldBox ObjectMotion::bounds() const noexcept {
  return widened({center_m_ - half_size_m_, center_m_ + half_size_m_},
                 rounding_m(glm::abs(center_m_) + half_size_m_, radius_m_));
}

ObjectMotion::Way ObjectMotion::way_between(double from_s, double to_s) const noexcept {
  const double begin_s = std::max(from_s - course_.time_s, 0.0),
               end_s = std::max(to_s - course_.time_s, begin_s);
  const glm::dvec3 &velocity = course_.velocity_m_per_s, &before = course_.velocity_before_m_per_s;
  const double squared = glm::dot(velocity, velocity);
  glm::dvec3 across(0.0);  // acceleration at right angles to the velocity
  double bend_squared = 0.0;
  if (glm::dot(velocity, before) > 0.0) {
    const glm::dvec3 change = (velocity - before) / course_.between_s;
    across = change - velocity * (glm::dot(change, velocity) / squared);
    bend_squared = glm::dot(across, across) / squared;
  }
  const double turn = turn_squared();
  const double speed = std::sqrt(squared),
               point_speed = speed + (turn > 0.0 ? radius_m_ * std::sqrt(turn) : 0.0);
  const bool little = std::max(turn, bend_squared) * end_s * end_s <= k_little_turn_rad * k_little_turn_rad;
  return {little ? turning_little(begin_s, end_s, across, turn, speed) : turning(begin_s, end_s),
          point_speed};
}

/// A turn by a moves a point at p from the centre along a way that leaves the straight one by |p| a^2 / 2 at
/// most, and the speed known is that of the last step's middle. The straight way's ends tell all of it. The
/// centre goes along a parabola rather than an arc, which differ by a sixth of the angle squared of the way.
WorldBox ObjectMotion::turning_little(double begin_s, double end_s, const glm::dvec3& across,
                                      double turn_squared, double speed_m_per_s) const noexcept {
  glm::dvec3 size_at_begin = half_size_m_, size_at_end = half_size_m_;
  double rise = 0.0;
  if (turn_squared > 0.0) {
    const glm::dvec3 half = half_size_of(object_bounds_);
    size_at_begin = size_at_end = glm::dvec3(0.0);
    for (int axis = 0; axis < 3; ++axis) {
      const glm::dvec3& edge = world_from_object_[axis];
      const glm::dvec3& speed = course_.linear_per_s[axis];
      size_at_begin += glm::abs(edge + begin_s * speed) * half[axis];
      size_at_end += glm::abs(edge + end_s * speed) * half[axis];
    }
    rise += 0.5 * radius_m_ * turn_squared * end_s * (end_s + course_.step_s);
  }
  if (speed_m_per_s > 0.0) {
    const double passed_s = end_s - begin_s, reach_s = end_s + course_.step_s,
                 across_squared = glm::dot(across, across);
    rise += 0.125 * passed_s * passed_s * std::sqrt(across_squared) +
            end_s * reach_s * reach_s / 6.0 * across_squared / speed_m_per_s;
  }
  // The mean velocity is that of the step's middle.
  const glm::dvec3 velocity = course_.velocity_m_per_s + across * (0.5 * course_.step_s);
  const glm::dvec3 at_begin = center_m_ + (velocity + across * (0.5 * begin_s)) * begin_s;
  const glm::dvec3 at_end = center_m_ + (velocity + across * (0.5 * end_s)) * end_s;
  const WorldBox way{glm::min(at_begin - size_at_begin, at_end - size_at_end),
                     glm::max(at_begin + size_at_begin, at_end + size_at_end)};
  const glm::dvec3 reach = glm::max(glm::abs(way.min), glm::abs(way.max));
  return widened(way, rise + rounding_m(reach, radius_m_));
}

WorldBox ObjectMotion::turning(double begin_s, double end_s) const noexcept {
  const glm::dmat3 linear(world_from_object_);
  const glm::dvec3 turn_per_s =
      course_.step_s > k_least_step_s
          ? rotation_between(linear - course_.linear_per_s * course_.step_s, linear) / course_.step_s
          : glm::dvec3(0.0);
  const glm::dvec3 bend_per_s =
      bend_between(course_.velocity_before_m_per_s, course_.velocity_m_per_s, course_.between_s);
  const double turn = glm::length(turn_per_s), bend = glm::length(bend_per_s);
  const auto pieces_of = [&](double rad_per_s) {
    return std::ceil(rad_per_s * (end_s - begin_s) / k_piece_rad);
  };
  // What turns too fast is taken for a ball.
  const bool ball = pieces_of(turn) > k_most_pieces_of_a_way;
  const int pieces = static_cast<int>(std::clamp(std::max(pieces_of(bend), ball ? 0.0 : pieces_of(turn)), 1.0,
                                                 double{k_most_pieces_of_a_way}));
  const double piece_s = (end_s - begin_s) / pieces;
  const glm::dvec3 half = half_size_of(object_bounds_);
  const Arc arc(center_m_, course_.velocity_m_per_s, bend_per_s, course_.step_s);

  WorldBox way{glm::dvec3(INFINITY), glm::dvec3(-INFINITY)};
  for (int i = 0; i <= pieces; ++i) {
    const double passed_s = begin_s + i * piece_s;
    const glm::dvec3 size =
        ball ? glm::dvec3(radius_m_) : half_size_after(turned(linear, turn_per_s * passed_s), half);
    const glm::dvec3 center = arc.after(passed_s);
    way.min = glm::min(way.min, center - size);
    way.max = glm::max(way.max, center + size);
  }
  // Between two places a point leaves the straight line by what an arc rises above its chord, r a^2 / 8.
  const double rise =
      0.125 * piece_s * piece_s * ((ball ? 0.0 : radius_m_ * turn * turn) + arc.acceleration());
  const glm::dvec3 reach = glm::max(glm::abs(way.min), glm::abs(way.max));
  return widened(way, rise + rounding_m(reach, radius_m_));
}

bool is_jump(double way_m, double step_s, double last_way_m, double last_step_s) noexcept {
  if (!(step_s > k_least_step_s)) return true;
  if (way_m <= k_jump_m) return false;
  const double last_speed_m_per_s = last_step_s > k_least_step_s ? last_way_m / last_step_s : 0.0;
  return !(way_m <= k_jump_m + k_jump_speed_factor * last_speed_m_per_s * step_s);
}

}  // namespace sightline
