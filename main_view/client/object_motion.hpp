#pragma once

#include <algorithm>

#include <glm/common.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x3.hpp>
#include <glm/vec3.hpp>

#include "common/bounds.hpp"

namespace sightline {

/// Where one object is and how it moves: the centre of its bounds along a line or a circle, and the object
/// turning about that centre, each at the speed of its last step. A door on its hinge, a wheel that rolls, a
/// car in a bend and a fan are each extrapolated as what they are. World frame, metres, seconds of the
/// client's clock.
class ObjectMotion {
 public:
  /// How it goes on.
  struct Course {
    double time_s = 0.0;  ///< when it came to stand there
    double step_s = 0.0;
    double last_way_m = 0.0;                  ///< of the last step, even if that was a jump
    glm::dvec3 velocity_m_per_s{0.0};         ///< of the centre, mean of the last step
    glm::dvec3 velocity_before_m_per_s{0.0};  ///< of the step before; 0 where one of them has no direction
    double between_s = 0.0;                   ///< the middles of the two steps
    glm::dmat3 linear_per_s{0.0};             ///< how fast the linear part changed in the last step
  };

  /// At rest. `object_bounds` is in the object's own frame and holds all it draws.
  ObjectMotion(const Aabb& object_bounds, const glm::dmat4x3& world_from_object) noexcept;
  ObjectMotion(const Aabb& object_bounds, const glm::dmat4x3& world_from_object,
               const Course& course) noexcept;

  /// It stood where it is until `from_s` and stands at `world_from_object` at `to_s`. Returns false when that
  /// was a jump, which says nothing of any speed: a step of more than half a metre, and far more than its
  /// speed before explains. It then counts as being at rest.
  bool step(double from_s, double to_s, const glm::dmat4x3& world_from_object) noexcept;
  void stop() noexcept;
  void set_object_bounds(const Aabb& object_bounds) noexcept;
  /// It stands there, however it came; at rest.
  void place(const glm::dmat4x3& world_from_object) noexcept;

  [[nodiscard]] const glm::dmat4x3& world_from_object() const noexcept { return world_from_object_; }
  /// Box around the object where it is; allows for single precision in the object's own shape.
  [[nodiscard]] WorldBox bounds() const noexcept;
  /// Box around the object wherever it is between two times, going on as it does. Contains every place on the
  /// extrapolated way, not only some; what it does not contain is a change of speed. Times before the last
  /// step's count as that.
  [[nodiscard]] WorldBox bounds_between(double from_s, double to_s) const noexcept {
    return way_between(from_s, to_s).bounds;
  }
  struct Way {
    WorldBox bounds;
    double speed_m_per_s = 0.0;  ///< of its fastest point, errs upwards
  };
  [[nodiscard]] Way way_between(double from_s, double to_s) const noexcept;
  [[nodiscard]] double speed_m_per_s() const noexcept {
    return way_between(course_.time_s, course_.time_s).speed_m_per_s;
  }
  [[nodiscard]] const Course& course() const noexcept { return course_; }
  [[nodiscard]] const Aabb& object_bounds() const noexcept { return object_bounds_; }
  [[nodiscard]] const glm::dvec3& center_m() const noexcept { return center_m_; }
  /// From its centre to the farthest corner of the box around it.
  [[nodiscard]] double radius_m() const noexcept { return radius_m_; }

 private:
  void measure() noexcept;
  [[nodiscard]] double turn_squared() const noexcept;
  [[nodiscard]] WorldBox turning_little(double begin_s, double end_s, const glm::dvec3& across,
                                        double turn_squared, double speed_m_per_s) const noexcept;
  [[nodiscard]] WorldBox turning(double begin_s, double end_s) const noexcept;

  Aabb object_bounds_;
  glm::dmat4x3 world_from_object_;
  glm::dvec3 center_m_{0.0};     ///< of the bounds, world frame
  glm::dvec3 half_size_m_{0.0};  ///< of the box around it
  double radius_m_ = 0.0;
  Course course_;
};

/// The shortest step that says anything of a speed, seconds.
inline constexpr double k_least_step_s = 1e-6;
/// Whether a step of `way_m` in `step_s` says nothing of a speed: it took no time, or is longer than half a
/// metre and far longer than the last step's `last_way_m` in `last_step_s` explains. True for NaN.
[[nodiscard]] bool is_jump(double way_m, double step_s, double last_way_m, double last_step_s) noexcept;

/// By how much `inner` reaches out of `outer`, metres on the worst side; 0 when it does not.
[[nodiscard]] inline double excess_m(const WorldBox& outer, const WorldBox& inner) noexcept {
  const glm::dvec3 out = glm::max(outer.min - inner.min, inner.max - outer.max);
  return std::max(std::max(out.x, out.y), std::max(out.z, 0.0));
}
[[nodiscard]] inline WorldBox widened(const WorldBox& box, double by_m) noexcept {
  return {box.min - by_m, box.max + by_m};
}

}  // namespace sightline
