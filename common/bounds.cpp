#include "common/bounds.hpp"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/vec4.hpp>

namespace sightline {

void Aabb::add(const glm::vec3& point) noexcept {
  min = glm::min(min, point);
  max = glm::max(max, point);
}

void Aabb::add(const Aabb& other) noexcept {
  min = glm::min(min, other.min);
  max = glm::max(max, other.max);
}

Aabb transformed(const Aabb& box, const glm::dmat4& transform) noexcept {
  if (box.empty()) return box;
  // Arvo, "Transforming Axis-Aligned Bounding Boxes", Graphics Gems, 1990: each output side is the
  // translation plus, per input axis, the smaller (larger) of the two products.
  glm::dvec3 low(transform[3]);
  glm::dvec3 high = low;
  glm::dvec3 magnitude = glm::abs(low);
  for (int axis = 0; axis < 3; ++axis) {
    const glm::dvec3 column(transform[axis]);
    const glm::dvec3 at_min = column * static_cast<double>(box.min[axis]);
    const glm::dvec3 at_max = column * static_cast<double>(box.max[axis]);
    low += glm::min(at_min, at_max);
    high += glm::max(at_min, at_max);
    magnitude += glm::max(glm::abs(at_min), glm::abs(at_max));
  }
  // A single-precision evaluation of the same sum errs by ulps of its largest term, not of its result.
  constexpr double k_ulp = 0x1p-23;
  const double pad = 4.0 * k_ulp * std::max({magnitude.x, magnitude.y, magnitude.z});
  Aabb result;
  for (int axis = 0; axis < 3; ++axis) {
    result.min[axis] = std::nextafter(static_cast<float>(low[axis] - pad), -INFINITY);
    result.max[axis] = std::nextafter(static_cast<float>(high[axis] + pad), INFINITY);
  }
  return result;
}

}  // namespace sightline
