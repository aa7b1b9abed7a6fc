#pragma once

#include <span>
#include <vector>

#include "common/object_hierarchy.hpp"
#include "common/view.hpp"
#include "main_view/client/culling_core.hpp"

namespace sightline {

/// Turns a decision into what is drawn: the objects that may intersect the view frustum of some eye and that
/// the decision does not hide. Keeps its memory from frame to frame.
class DrawListBuilder {
 public:
  /// `hierarchy` is over scene-frame bounds and must outlive this.
  DrawListBuilder(const ObjectHierarchy& hierarchy, const glm::dvec3& world_origin_m)
      : hierarchy_(hierarchy), world_origin_m_(world_origin_m) {}

  /// Objects in the view frustum of any eye, ascending. Valid until the next call.
  const std::vector<ObjectId>& in_frustum(std::span<const Eye> eyes);

  /// Of those, the ones that `decision` draws. Calls in_frustum.
  const std::vector<ObjectId>& visible(std::span<const Eye> eyes, const FrameDecision& decision);

 private:
  const ObjectHierarchy& hierarchy_;
  glm::dvec3 world_origin_m_;
  std::vector<ObjectId> in_frustum_, one_eye_, merged_, visible_;
};

}  // namespace sightline
