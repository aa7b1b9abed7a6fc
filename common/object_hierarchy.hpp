#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/bounds.hpp"
#include "common/frustum.hpp"
#include "common/object_id.hpp"

namespace sightline {

/// Bounding volume hierarchy over the objects of a scene.
///
/// Walk it yourself through nodes() and objects_of(); or ask for everything in a frustum.
///
/// Source: top-down binned surface-area build after Wald, "On fast Construction of SAH-based Bounding Volume
/// Hierarchies", 2007; refit bottom-up when objects move.
class ObjectHierarchy {
 public:
  /// Nodes lie in depth-first order: the root is node 0, a node's left child follows it. Every subtree's
  /// objects are one run of slots.
  struct Node {
    Aabb box;
    std::uint32_t right = 0;  ///< index of the right child, 0 for a leaf
    std::uint32_t parent = 0;
    std::uint32_t first_slot = 0;
    std::uint32_t end_slot = 0;

    [[nodiscard]] bool is_leaf() const noexcept { return right == 0; }
  };
  /// No path from the root to a leaf is longer: a walk needs a stack of this many nodes, and one.
  static constexpr std::uint32_t k_max_depth = 80;

  ObjectHierarchy() = default;
  /// `bounds[i]` is the world box of ObjectId i. Objects with an empty box are never reported.
  explicit ObjectHierarchy(std::span<const Aabb> bounds);

  /// Replaces the boxes of `ids` (an empty box hides the object, a later one shows it again) and refits. Cost
  /// follows the number moved times the depth; the tree's shape stays, so a scene that is shuffled completely
  /// is better rebuilt.
  void move(std::span<const ObjectId> ids, std::span<const Aabb> bounds);

  /// Appends to `out`, in ascending id order, every object that may intersect the frustum.
  /// Conservative as may_intersect is. Clears `out` first; allocates only while `out` still grows.
  void collect_in_frustum(const Frustum& frustum, std::vector<ObjectId>& out) const;

  [[nodiscard]] const Aabb& bounds_of(ObjectId id) const noexcept { return bounds_[index_of(id)]; }
  [[nodiscard]] std::span<const Aabb> bounds() const noexcept { return bounds_; }
  [[nodiscard]] std::uint32_t object_count() const noexcept {
    return static_cast<std::uint32_t>(bounds_.size());
  }
  /// Empty when there are no objects. Boxes change in move, nothing else ever does.
  [[nodiscard]] std::span<const Node> nodes() const noexcept { return nodes_; }
  /// The objects below a node, in no order of their own; those whose box is empty among them.
  [[nodiscard]] std::span<const ObjectId> objects_of(const Node& node) const noexcept {
    return {order_.data() + node.first_slot, order_.data() + node.end_slot};
  }

 private:
  friend class ObjectHierarchyBuilder;

  [[nodiscard]] Aabb union_of_slots(const Node& leaf) const noexcept;
  void refit_from(std::uint32_t leaf) noexcept;
  void append_run(std::uint32_t first_slot, std::uint32_t end_slot, std::vector<ObjectId>& out) const;

  std::vector<Aabb> bounds_;
  std::vector<Node> nodes_;
  std::vector<ObjectId> order_;         ///< slot to object
  std::vector<std::uint32_t> leaf_of_;  ///< object to its leaf node
  std::uint32_t empty_count_ = 0;       ///< objects whose box is empty now
};

}  // namespace sightline
