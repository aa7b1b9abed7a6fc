#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/object_hierarchy.hpp"

namespace sightline {

/// Builds the nodes of an ObjectHierarchy, top down, without recursion.
///
/// Source: Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007. We bin along the
/// widest axis of the centroids only, as the paper's fast variant does, and cut by count below a depth at
/// which only a pathological spread of sizes would still be unsplit; the depth of the tree is therefore
/// bounded by k_max_depth.
class ObjectHierarchyBuilder {
 public:
  static constexpr std::uint32_t k_max_leaf_objects = 4;
  static constexpr std::uint32_t k_last_surface_depth = 48;
  /// 32 halvings of at most 2^32 objects below the last surface-area split.
  static constexpr std::uint32_t k_max_depth = k_last_surface_depth + 32;
  static_assert(k_max_depth == ObjectHierarchy::k_max_depth);

  explicit ObjectHierarchyBuilder(ObjectHierarchy& hierarchy) : hierarchy_(hierarchy) {}
  void build();

 private:
  struct Item {
    Aabb box;
    glm::vec3 center;  ///< finite, also where the box is not
    ObjectId id;
  };
  struct Task {
    std::uint32_t first;
    std::uint32_t end;
    std::uint32_t parent;
    std::uint32_t depth;
    bool is_right;
  };

  void make_items();
  [[nodiscard]] std::uint32_t split(std::span<Item> items, std::uint32_t depth);
  void make_leaf(std::uint32_t node_index, std::span<const Item> items);

  ObjectHierarchy& hierarchy_;
  std::vector<Item> items_;
};

}  // namespace sightline
