#include "common/frustum.hpp"

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace sightline {
namespace {

/// Where the box's centre lies relative to a plane, how far its corners reach along the normal, and by how
/// much rounding may have falsified the two together.
struct PlaneDistance {
  double center;
  double reach;
  double rounding;
};

PlaneDistance distance_to(const glm::dvec4& plane, const Aabb& box) noexcept {
  const glm::dvec3 low(box.min);
  const glm::dvec3 high(box.max);
  const glm::dvec3 center = 0.5 * (low + high);
  const glm::dvec3 half = 0.5 * (high - low);
  const glm::dvec3 normal(plane);
  const double along = glm::dot(normal, center);
  const double reach = glm::dot(glm::abs(normal), half);
  return {along + plane.w, reach,
          1e-14 * (glm::dot(glm::abs(normal), glm::abs(center)) + reach + std::abs(plane.w))};
}

}  // namespace

Frustum frustum_of(const glm::dmat4& clip_from_world) noexcept {
  // A clip coordinate is a row's product with the world point; -w <= x is (row3 + row0) . p >= 0, and so on.
  const glm::dmat4 rows = glm::transpose(clip_from_world);
  Frustum frustum{};
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const glm::dvec4 plane = side == 0 ? rows[3] + rows[axis] : rows[3] - rows[axis];
      const double length = glm::length(glm::dvec3(plane));
      // An infinite projection's far plane cancels to rounding noise.
      const double noise = 1e-12 * (glm::length(glm::dvec3(rows[3])) + glm::length(glm::dvec3(rows[axis])));
      const bool lacking = !(length > noise);
      frustum.planes[static_cast<std::size_t>(2 * axis + side)] =
          lacking ? glm::dvec4(0.0, 0.0, 0.0, 1.0) : plane / length;
    }
  }
  return frustum;
}

// Both tests are written so that a NaN in a box or plane answers "may intersect" and "not contained".

bool may_intersect(const Frustum& frustum, const Aabb& box) noexcept {
  if (box.empty()) return false;
  for (const glm::dvec4& plane : frustum.planes) {
    const PlaneDistance distance = distance_to(plane, box);
    if (distance.center + distance.reach < -distance.rounding) return false;
  }
  return true;
}

bool definitely_contains(const Frustum& frustum, const Aabb& box) noexcept {
  if (box.empty()) return false;
  for (const glm::dvec4& plane : frustum.planes) {
    const PlaneDistance distance = distance_to(plane, box);
    if (!(distance.center - distance.reach > distance.rounding)) return false;
  }
  return true;
}

}  // namespace sightline
