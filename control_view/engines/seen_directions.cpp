#include "control_view/engines/seen_directions.hpp"

#include <algorithm>

#include <glm/matrix.hpp>

namespace sightline {

SeenDirections::SeenDirections(const Eye& eye, ImageSize image)
    : perspective_(is_upright_perspective(eye.clip_from_camera)),
      world_from_camera_(glm::transpose(glm::dmat3(eye.camera_from_world))),
      projection_(eye.clip_from_camera),
      width_(image.width),
      height_(image.height) {}

DirectionExtent SeenDirections::of(std::int32_t left, std::int32_t bottom, std::int32_t right,
                                   std::int32_t top, float nearest_depth) const {
  if (!perspective_) return k_seen_anywhere;
  const auto across = [&](double pixel) {
    return (2.0 * pixel / width_ - 1.0 + projection_[2][0]) / projection_[0][0];
  };
  const auto up = [&](double pixel) {
    return (2.0 * pixel / height_ - 1.0 + projection_[2][1]) / projection_[1][1];
  };
  const double x0 = across(left - 1.0), x1 = across(right + 2.0);
  const double y0 = up(bottom - 1.0), y1 = up(top + 2.0);
  // Along the view's axis; a point off the axis is farther. Rounded towards the eye.
  const double ndc = 1.0 - 2.0 * std::min(1.0, 1.0001 * static_cast<double>(nearest_depth) + 1e-9);
  const double nearest_m = 0.999 * projection_[3][2] / (ndc + projection_[2][2]);
  const auto ray = [&](double x, double y) { return world_from_camera_ * glm::dvec3(x, y, -1.0); };
  return extent_of_piece({ray(x0, y0), ray(x1, y0), ray(x1, y1), ray(x0, y1)}, nearest_m);
}

}  // namespace sightline
