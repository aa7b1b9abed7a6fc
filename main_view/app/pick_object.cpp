#include "main_view/app/pick_object.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace sightline {

Ray ray_through(const Eye& eye, ImageSize image, double x_px, double y_px) {
  const double x = 2.0 * x_px / image.width - 1.0;
  const double y = 1.0 - 2.0 * y_px / image.height;
  const glm::dmat4 camera_from_clip = glm::inverse(eye.clip_from_camera);
  const auto in_camera = [&](double depth) {
    const glm::dvec4 point = camera_from_clip * glm::dvec4(x, y, depth, 1.0);
    return glm::dvec3(point) / point.w;
  };
  const glm::dvec3 near_m = in_camera(-1.0), farther_m = in_camera(0.0);
  const glm::dmat4 world_from_camera = glm::inverse(eye.camera_from_world);
  return {glm::dvec3(world_from_camera * glm::dvec4(near_m, 1.0)),
          glm::normalize(glm::dmat3(world_from_camera) * (farther_m - near_m))};
}

std::optional<double> entry_m(const Ray& ray, const Aabb& box, const glm::dvec3& world_origin_m) {
  if (box.empty()) return {};
  double enters = 0.0, leaves = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double low = box.min[axis] + world_origin_m[axis] - ray.origin[axis];
    const double high = box.max[axis] + world_origin_m[axis] - ray.origin[axis];
    if (ray.direction[axis] == 0.0) {
      if (low > 0.0 || high < 0.0) return {};
      continue;
    }
    double first = low / ray.direction[axis], last = high / ray.direction[axis];
    if (first > last) std::swap(first, last);
    enters = std::max(enters, first);
    leaves = std::min(leaves, last);
  }
  if (enters > leaves) return {};
  return enters;
}

std::optional<ObjectId> nearest_box_under(const Ray& ray, std::span<const ObjectId> ids,
                                          std::span<const Aabb> bounds, const glm::dvec3& world_origin_m) {
  std::optional<ObjectId> nearest;
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const ObjectId id : ids) {
    const std::optional<double> at_m = entry_m(ray, bounds[index_of(id)], world_origin_m);
    if (!at_m || *at_m <= 0.0) continue;
    if (*at_m < nearest_m || (*at_m == nearest_m && nearest && id < *nearest)) {
      nearest = id;
      nearest_m = *at_m;
    }
  }
  return nearest;
}

}  // namespace sightline
