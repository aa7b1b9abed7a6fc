#include "main_view/app/draw_list.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include <glm/gtc/matrix_transform.hpp>

namespace sightline {
namespace {

/// The box moved by `offset_m`. Errs towards larger: by one float step (at 1,000 km, 6 cm) on each side,
/// where rounding alone errs by half of one either way.
Aabb moved_outwards(const Aabb& box, const glm::dvec3& offset_m) {
  constexpr float k_infinity = std::numeric_limits<float>::infinity();
  Aabb moved;
  for (int axis = 0; axis < 3; ++axis) {
    moved.min[axis] = std::nextafter(static_cast<float>(box.min[axis] + offset_m[axis]), -k_infinity);
    moved.max[axis] = std::nextafter(static_cast<float>(box.max[axis] + offset_m[axis]), k_infinity);
  }
  return moved;
}

}  // namespace

const std::vector<ObjectId>& DrawListBuilder::in_frustum(std::span<const Eye> eyes) {
  in_frustum_.clear();
  const glm::dmat4 world_from_scene = glm::translate(glm::dmat4(1.0), world_origin_m_);
  for (const Eye& eye : eyes) {
    hierarchy_.collect_in_frustum(frustum_of(eye.clip_from_world() * world_from_scene), one_eye_);
    if (eyes.size() == 1) {
      in_frustum_.swap(one_eye_);
      break;
    }
    merged_.clear();
    std::set_union(in_frustum_.begin(), in_frustum_.end(), one_eye_.begin(), one_eye_.end(),
                   std::back_inserter(merged_));
    in_frustum_.swap(merged_);
  }
  return in_frustum_;
}

const std::vector<ObjectId>& DrawListBuilder::visible(std::span<const Eye> eyes,
                                                      const FrameDecision& decision) {
  in_frustum(eyes);
  if (decision.fallback != Fallback::none && decision.moved.absent.empty()) return in_frustum_;
  visible_.clear();
  for (const ObjectId id : in_frustum_) {
    const Aabb world_bounds = moved_outwards(hierarchy_.bounds_of(id), world_origin_m_);
    if (decision.may_be_visible(id, world_bounds)) visible_.push_back(id);
  }
  return visible_;
}

}  // namespace sightline
