#pragma once

#include <array>
#include <cstddef>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "common/bounds.hpp"
#include "common/view.hpp"

namespace sightline {

/// All that a box may hide from an eye: everything on the rays through the box, from its front onwards.
///
/// The volume is convex. It is bounded by the faces of the box that the eye sees and by the planes through
/// the eye and the box's outline. World frame, metres; computed relative to the eye, so that it stays sharp
/// far from the origin.
class OccluderShadow {
 public:
  /// For any viewpoint within `slack_m` of the eye. An eye inside the box sees nothing but it: then
  /// everything is in the shadow, as for a projection that is neither perspective nor parallel. Requires
  /// finite values.
  OccluderShadow(const Eye& eye, const WorldBox& box, double slack_m) noexcept;

  /// Whether the shadow depends on where the eye is and not on where it looks: shadows of eyes close to each
  /// other are then one with some slack.
  [[nodiscard]] static bool depends_on_place_alone(const Eye& eye) noexcept;

  /// Whether anything in `world_bounds` may lie in the shadow. Errs towards true: a box beside the shadow's
  /// edge, where two planes meet, may be taken for one inside. False for an empty box.
  [[nodiscard]] bool may_hold(const Aabb& world_bounds) const noexcept;

 private:
  void add_outline(const WorldBox& box, const glm::ivec3& side, const glm::dvec3* towards_eye) noexcept;

  static constexpr std::size_t k_most_planes = 6;  // outline of a box

  glm::dvec3 origin_m_{0.0};  ///< all below is relative to it
  double slack_m_ = 0.0;
  bool everything_ = false;
  glm::dvec3 low_;   ///< a box wholly below this on some axis lies before the front
  glm::dvec3 high_;  ///< likewise above
  std::array<glm::dvec4, k_most_planes> planes_{};  ///< normals point into the shadow
  std::size_t plane_count_ = 0;
};

}  // namespace sightline
