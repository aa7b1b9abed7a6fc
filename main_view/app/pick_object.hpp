#pragma once

#include <optional>
#include <span>

#include <glm/vec3.hpp>

#include "common/bounds.hpp"
#include "common/object_id.hpp"
#include "common/view.hpp"

namespace sightline {

/// A half-line in the world frame, metres; `direction` has length 1.
struct Ray {
  glm::dvec3 origin{0.0};
  glm::dvec3 direction{0.0, 0.0, -1.0};
};

/// What lies under a point of the image, from the near plane on. `x_px` and `y_px` are from the upper left
/// corner, as a cursor is told; a pixel's middle is at a half.
[[nodiscard]] Ray ray_through(const Eye& eye, ImageSize image, double x_px, double y_px);

/// How far along the ray it enters the box, metres; 0 where it begins inside, nothing where it misses. An
/// empty box is always missed.
[[nodiscard]] std::optional<double> entry_m(const Ray& ray, const Aabb& box,
                                            const glm::dvec3& world_origin_m);

/// Of the objects `ids` the one whose box the ray enters first, the lowest id where several are as near.
/// Boxes that the ray begins in are passed over: they are around the camera, not under the cursor.
/// `bounds` are by object, scene frame: the world's, moved by `world_origin_m`.
[[nodiscard]] std::optional<ObjectId> nearest_box_under(const Ray& ray, std::span<const ObjectId> ids,
                                                        std::span<const Aabb> bounds,
                                                        const glm::dvec3& world_origin_m);

}  // namespace sightline
