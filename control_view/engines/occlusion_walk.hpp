#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/object_hierarchy.hpp"
#include "control_view/engines/depth_hierarchy.hpp"
#include "control_view/engines/screen_box.hpp"

namespace sightline {

/// Calls `found(id, screen_box)` for every object that may show, in no order of its own. Conservative: an
/// object is left out only when its box, or one around it, lies outside the view or behind every pixel it may
/// cover. Objects for which `skipped(id)` holds are not tested.
template <class Skipped, class Found>
void walk_what_may_show(const ObjectHierarchy& hierarchy, const BoxProjector& projector,
                        const DepthHierarchy& depth, Skipped skipped, Found found) {
  const auto nodes = hierarchy.nodes();
  if (nodes.empty()) return;
  const auto test = [&](const Aabb& box) {
    std::optional<ScreenBox> screen = projector.project(box);
    if (screen && !depth.may_show(*screen)) screen.reset();
    return screen;
  };
  std::array<std::uint32_t, ObjectHierarchy::k_max_depth + 2> stack;
  std::size_t waiting = 0;
  stack[waiting++] = 0;
  while (waiting > 0) {
    const std::uint32_t index = stack[--waiting];
    const ObjectHierarchy::Node& node = nodes[index];
    if (!test(node.box)) continue;
    if (!node.is_leaf()) {
      stack[waiting++] = node.right;
      stack[waiting++] = index + 1;
      continue;
    }
    for (const ObjectId id : hierarchy.objects_of(node)) {
      if (skipped(id)) continue;
      if (const auto screen = test(hierarchy.bounds_of(id))) found(id, *screen);
    }
  }
}

/// A node or an object waiting for its turn, and how near its box comes.
struct NearestFirstEntry {
  float nearest_depth = 0.0f;
  std::uint32_t index = 0;  ///< of a node, or an ObjectId
  bool is_object = false;
};

/// Calls `found(id)` for the objects in view, nearest box first, until it answers false. `heap` is scratch
/// memory. Cost follows what is called for, not what exists.
template <class Found>
void walk_nearest_first(const ObjectHierarchy& hierarchy, const BoxProjector& projector,
                        std::vector<NearestFirstEntry>& heap, Found found) {
  const auto nodes = hierarchy.nodes();
  const auto farther = [](const NearestFirstEntry& a, const NearestFirstEntry& b) {
    return a.nearest_depth < b.nearest_depth;
  };
  const auto push = [&](const Aabb& box, std::uint32_t index, bool is_object) {
    const auto screen = projector.project(box);
    if (!screen) return;
    heap.push_back({screen->nearest_depth, index, is_object});
    std::push_heap(heap.begin(), heap.end(), farther);
  };
  heap.clear();
  if (!nodes.empty()) push(nodes.front().box, 0, false);
  while (!heap.empty()) {
    std::pop_heap(heap.begin(), heap.end(), farther);
    const NearestFirstEntry next = heap.back();
    heap.pop_back();
    if (next.is_object) {
      if (!found(ObjectId{next.index})) return;
      continue;
    }
    const ObjectHierarchy::Node& node = nodes[next.index];
    if (node.is_leaf()) {
      for (const ObjectId id : hierarchy.objects_of(node)) push(hierarchy.bounds_of(id), index_of(id), true);
    } else {
      push(nodes[next.index + 1].box, next.index + 1, false);
      push(nodes[node.right].box, node.right, false);
    }
  }
}

}  // namespace sightline
