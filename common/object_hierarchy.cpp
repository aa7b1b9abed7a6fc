#include "common/object_hierarchy.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

#include <glm/geometric.hpp>

#include "common/object_hierarchy_builder.hpp"
#include "common/sort_object_ids.hpp"

namespace sightline {
namespace {

/// One bit a plane: those the box still straddles.
using PlaneMask = std::uint32_t;
constexpr PlaneMask k_all_planes = 0x3f;
constexpr PlaneMask k_outside = 0x80;

/// A plane with what the test needs of it, computed once a frustum.
struct TestPlane {
  glm::dvec3 normal;
  glm::dvec3 abs_normal;
  double offset;
};

/// The same test and the same tolerance as may_intersect and definitely_contains, for the planes in `mask`
/// only.
PlaneMask straddled_planes(const std::array<TestPlane, 6>& planes, const Aabb& box, PlaneMask mask) {
  const glm::dvec3 low(box.min);
  const glm::dvec3 high(box.max);
  const glm::dvec3 center = 0.5 * (low + high);
  const glm::dvec3 half = 0.5 * (high - low);
  const glm::dvec3 abs_center = glm::abs(center);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const PlaneMask bit = 1u << i;
    if ((mask & bit) == 0) continue;
    const TestPlane& plane = planes[i];
    const double distance = glm::dot(plane.normal, center) + plane.offset;
    const double reach = glm::dot(plane.abs_normal, half);
    const double rounding = 1e-14 * (glm::dot(plane.abs_normal, abs_center) + reach + std::abs(plane.offset));
    if (distance + reach < -rounding) return k_outside;
    if (distance - reach > rounding) mask &= ~bit;
  }
  return mask;
}

bool same(const Aabb& a, const Aabb& b) {
  return a.min == b.min && a.max == b.max;
}

}  // namespace

ObjectHierarchy::ObjectHierarchy(std::span<const Aabb> bounds) : bounds_(bounds.begin(), bounds.end()) {
  empty_count_ = static_cast<std::uint32_t>(
      std::count_if(bounds_.begin(), bounds_.end(), [](const Aabb& box) { return box.empty(); }));
  ObjectHierarchyBuilder(*this).build();
}

void ObjectHierarchy::move(std::span<const ObjectId> ids, std::span<const Aabb> bounds) {
  for (std::size_t i = 0; i < ids.size(); ++i) {
    Aabb& box = bounds_[index_of(ids[i])];
    empty_count_ -= box.empty() ? 1 : 0;
    box = bounds[i];
    empty_count_ += box.empty() ? 1 : 0;
  }
  for (const ObjectId id : ids) refit_from(leaf_of_[index_of(id)]);
}

Aabb ObjectHierarchy::union_of_slots(const Node& leaf) const noexcept {
  Aabb box;
  for (std::uint32_t slot = leaf.first_slot; slot < leaf.end_slot; ++slot) box.add(bounds_of(order_[slot]));
  return box;
}

void ObjectHierarchy::refit_from(std::uint32_t leaf) noexcept {
  Aabb box = union_of_slots(nodes_[leaf]);
  for (std::uint32_t index = leaf; !same(nodes_[index].box, box);) {
    nodes_[index].box = box;
    if (index == 0) return;
    index = nodes_[index].parent;
    box = nodes_[index + 1].box;
    box.add(nodes_[nodes_[index].right].box);
  }
}

void ObjectHierarchy::collect_in_frustum(const Frustum& frustum, std::vector<ObjectId>& out) const {
  out.clear();
  if (nodes_.empty()) return;
  std::array<TestPlane, 6> planes;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const glm::dvec3 normal(frustum.planes[i]);
    planes[i] = {normal, glm::abs(normal), frustum.planes[i].w};
  }

  struct Pending {
    std::uint32_t node;
    PlaneMask mask;
  };
  // One right sibling waits on every level of the path.
  std::array<Pending, ObjectHierarchyBuilder::k_max_depth + 2> stack;
  std::size_t depth = 0;
  stack[depth++] = {0, k_all_planes};
  while (depth > 0) {
    const Pending next = stack[--depth];
    const Node& node = nodes_[next.node];
    if (node.box.empty()) continue;
    const PlaneMask mask = straddled_planes(planes, node.box, next.mask);
    if (mask == k_outside) continue;
    if (mask == 0) {
      append_run(node.first_slot, node.end_slot, out);
    } else if (node.right != 0) {
      stack[depth++] = {node.right, mask};
      stack[depth++] = {next.node + 1, mask};
    } else {
      for (std::uint32_t slot = node.first_slot; slot < node.end_slot; ++slot) {
        const Aabb& box = bounds_of(order_[slot]);
        if (!box.empty() && straddled_planes(planes, box, mask) != k_outside) out.push_back(order_[slot]);
      }
    }
  }
  sort_object_ids(out, object_count());
}

void ObjectHierarchy::append_run(std::uint32_t first_slot, std::uint32_t end_slot,
                                 std::vector<ObjectId>& out) const {
  const auto first = order_.begin() + first_slot;
  const auto end = order_.begin() + end_slot;
  if (empty_count_ == 0) {
    out.insert(out.end(), first, end);
    return;
  }
  std::copy_if(first, end, std::back_inserter(out), [&](ObjectId id) { return !bounds_of(id).empty(); });
}

}  // namespace sightline
