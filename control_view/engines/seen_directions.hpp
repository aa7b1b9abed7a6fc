#pragma once

#include <array>
#include <cstdint>

#include <glm/mat4x4.hpp>

#include "common/direction_extent.hpp"
#include "common/view.hpp"

namespace sightline {

/// Turns rectangles of an eye's image into directions of the world.
class SeenDirections {
 public:
  /// `image`: pixels of the whole image that rectangles are counted in.
  SeenDirections(const Eye& eye, ImageSize image);

  /// Pixels `left` to `right` and `bottom` to `top`, ends included, from the lower left; `nearest_depth` as
  /// in gl::depth_clip_from_scene (1 near, 0 far): nothing there is nearer. A pixel was sampled in its
  /// middle, so one more is taken on every side. Anywhere for projections that are no perspective, or beyond
  /// the middle of the eye.
  [[nodiscard]] DirectionExtent of(std::int32_t left, std::int32_t bottom, std::int32_t right,
                                   std::int32_t top, float nearest_depth) const;

 private:
  bool perspective_;
  glm::dmat3 world_from_camera_;
  glm::dmat4 projection_;
  double width_, height_;
};

}  // namespace sightline
