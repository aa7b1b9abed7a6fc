#pragma once

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
  /// At rest. `object_bounds` is in the object's own frame and holds all it draws.
  ObjectMotion(const Aabb& object_bounds, const glm::dmat4x3& world_from_object) noexcept;

  /// It stood where it is until `from_s` and stands at `world_from_object` at `to_s`. Returns false when that
  /// was a jump, which says nothing of any speed: a step of more than half a metre, and far more than its
  /// speed before explains. It then counts as being at rest.
  bool step(double from_s, double to_s, const glm::dmat4x3& world_from_object) noexcept;
  void stop() noexcept;
  void set_object_bounds(const Aabb& object_bounds) noexcept { object_bounds_ = object_bounds; }

  [[nodiscard]] const glm::dmat4x3& world_from_object() const noexcept { return world_from_object_; }
  /// Box around the object where it is; allows for single precision in the object's own shape.
  [[nodiscard]] WorldBox bounds() const noexcept;
  /// Box around the object wherever it is between two times, going on as it does. Contains every place on the
  /// extrapolated way, not only some; what it does not contain is a change of speed. Times before the last
  /// step's count as that.
  [[nodiscard]] WorldBox bounds_between(double from_s, double to_s) const noexcept;
  /// Metres that its fastest point goes in a second.
  [[nodiscard]] double speed_m_per_s() const noexcept;
  /// From one placement to the next, the last time.
  [[nodiscard]] double step_s() const noexcept { return step_s_; }

 private:
  [[nodiscard]] glm::dvec3 center_of(const glm::dmat4x3& world_from_object) const noexcept;
  [[nodiscard]] glm::dvec3 center_after(double passed_s) const noexcept;
  [[nodiscard]] double radius_m() const noexcept;

  Aabb object_bounds_;
  glm::dmat4x3 world_from_object_;
  double time_s_ = 0.0;  ///< when it came to stand there
  double step_s_ = 0.0;
  double last_speed_m_per_s_ = 0.0;     ///< of the last step, even if that was a jump
  glm::dvec3 velocity_m_per_s_{0.0};    ///< of the centre, at time_s_
  glm::dvec3 bend_rad_per_s_{0.0};      ///< how fast that turns
  glm::dvec3 rotation_rad_per_s_{0.0};  ///< of the object
  glm::dvec3 last_mean_velocity_m_per_s_{0.0};
};

/// By how much `inner` reaches out of `outer`, metres on the worst side; 0 when it does not.
[[nodiscard]] double excess_m(const WorldBox& outer, const WorldBox& inner) noexcept;
[[nodiscard]] WorldBox widened(const WorldBox& box, double by_m) noexcept;

}  // namespace sightline
