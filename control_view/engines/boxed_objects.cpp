#include "control_view/engines/boxed_objects.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <glm/geometric.hpp>

#include "control_view/engines/fine_test.hpp"

namespace sightline {
namespace {

/// Farthest w of the box's corners, clip space; linear, so a corner has it.
double farthest_w(const glm::dmat4& clip_from_world, const WorldBox& box) noexcept {
  double w = clip_from_world[3][3];
  for (int axis = 0; axis < 3; ++axis)
    w += std::max(clip_from_world[axis][3] * box.min[axis], clip_from_world[axis][3] * box.max[axis]);
  return w;
}

/// Metres across one pixel at depth w along a row of clip space (0: x, 1: y).
double pixel_m(const glm::dmat4& clip_from_camera, int row, std::uint32_t pixels, double w) noexcept {
  const double scale =
      glm::length(glm::dvec3(clip_from_camera[0][row], clip_from_camera[1][row], clip_from_camera[2][row]));
  return 2.0 * w / (scale * std::max(pixels, 1u));
}

}  // namespace

SceneEdits without_boxed(const SceneEdits& edits, std::span<const BoxedObject> boxed, std::uint64_t version) {
  constexpr std::uint64_t k_no_session = 0;  // sessions are numbered otherwise
  SceneEdits left_out = edits;
  left_out.owner = k_no_session;
  left_out.version = version;
  std::vector<ObjectId>& hidden = left_out.hidden;
  for (const BoxedObject& object : boxed) hidden.push_back(object.id);
  std::sort(hidden.begin(), hidden.end());
  hidden.erase(std::unique(hidden.begin(), hidden.end()), hidden.end());
  return left_out;
}

Aabb widened_by_a_pixel(const WorldBox& box, const Eye& eye, ImageSize image,
                        const glm::dvec3& world_origin_m) noexcept {
  // In the eye's neighbourhood first: far from the origin the product of both matrices has few digits left.
  const glm::dmat4& camera_from_world = eye.camera_from_world;
  const glm::dvec3 eye_m = position_of(eye);
  const glm::dmat4 clip_from_eye = eye.clip_from_camera * glm::dmat4(glm::dmat3(camera_from_world));
  const double w = std::max(farthest_w(clip_from_eye, {box.min - eye_m, box.max - eye_m}), 0.0);
  const double pad = std::max(pixel_m(eye.clip_from_camera, 0, image.width, w),
                              pixel_m(eye.clip_from_camera, 1, image.height, w));
  constexpr float k_infinity = std::numeric_limits<float>::infinity();
  Aabb widened;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = box.min[axis] - world_origin_m[axis] - pad;
    const double high = box.max[axis] - world_origin_m[axis] + pad;
    widened.min[axis] = std::nextafter(static_cast<float>(low), -k_infinity);
    widened.max[axis] = std::nextafter(static_cast<float>(high), k_infinity);
  }
  return widened;
}

void report_boxed(std::span<const BoxedObject> boxed, const FinishedView& view, CountAccumulator& sum) {
  for (const BoxedObject& object : boxed) {
    const Aabb box = widened_by_a_pixel(object.world_bounds, view.eye, view.image, view.world_origin_m);
    if (may_show_finely(view.projector, view.depth, box)) sum.add(object.id, 1);
  }
}

}  // namespace sightline
