#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/bounds.hpp"
#include "common/object_hierarchy.hpp"
#include "common/object_id.hpp"
#include "main_view/client/frustum_tester.hpp"

namespace sightline {

/// Where every object is now, world frame, so that all in a region can be found.
///
/// What moves is taken out of the hierarchy's account and looked at one by one: a move costs nothing there,
/// however many objects move. What has come to rest goes back a few at a time, in `settle`.
class PlacedBounds {
 public:
  explicit PlacedBounds(std::span<const Aabb> bounds);

  /// Empty where the object is not to be found.
  void place(ObjectId id, const Aabb& bounds);
  [[nodiscard]] const Aabb& bounds_of(ObjectId id) const noexcept { return bounds_[index_of(id)]; }
  [[nodiscard]] std::uint32_t object_count() const noexcept {
    return static_cast<std::uint32_t>(bounds_.size());
  }
  [[nodiscard]] std::size_t loose_count() const noexcept { return loose_.size(); }

  /// Call once a frame: brings back into the hierarchy what was not placed for k_rest_frames.
  void settle();

  /// Calls `found(id)` for every object whose bounds `holds` takes, and no other. `holds(box)` must be true
  /// for a box that contains one for which it is.
  template <typename Holds, typename Found>
  void visit(const Holds& holds, const Found& found) const;

  /// The same for all that may_intersect says of a frustum, cheaper where much is inside. `scratch` is
  /// overwritten.
  template <typename Found>
  void visit(const FrustumTester& frustum, std::vector<ObjectId>& scratch, const Found& found) const;

  static constexpr std::uint32_t k_rest_frames = 60;
  static constexpr std::size_t k_most_settled_a_frame = 64;

 private:
  std::vector<Aabb> bounds_;
  ObjectHierarchy hierarchy_;
  std::vector<ObjectId> loose_;
  std::vector<std::uint32_t> placed_in_;  ///< frame; 0: not loose
  std::uint32_t frame_ = 1;
};

template <typename Holds, typename Found>
void PlacedBounds::visit(const Holds& holds, const Found& found) const {
  const auto nodes = hierarchy_.nodes();
  std::uint32_t stack[ObjectHierarchy::k_max_depth + 2];
  std::size_t depth = 0;
  if (!nodes.empty()) stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t index = stack[--depth];
    const ObjectHierarchy::Node& node = nodes[index];
    if (node.box.empty() || !holds(node.box)) continue;
    if (!node.is_leaf()) {
      stack[depth++] = node.right;
      stack[depth++] = index + 1;
      continue;
    }
    for (const ObjectId id : hierarchy_.objects_of(node)) {
      const Aabb& box = bounds_of(id);
      if (placed_in_[index_of(id)] == 0 && !box.empty() && holds(box)) found(id);
    }
  }
  for (const ObjectId id : loose_) {
    const Aabb& box = bounds_of(id);
    if (!box.empty() && holds(box)) found(id);
  }
}

template <typename Found>
void PlacedBounds::visit(const FrustumTester& frustum, std::vector<ObjectId>& scratch,
                         const Found& found) const {
  hierarchy_.collect_in_frustum(frustum.frustum(), scratch);
  for (const ObjectId id : scratch) {
    if (placed_in_[index_of(id)] == 0) found(id);
  }
  for (const ObjectId id : loose_) {
    if (frustum.may_hold(bounds_of(id))) found(id);
  }
}

}  // namespace sightline
