#include "common/object_hierarchy_builder.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/widest_axis.hpp"

namespace sightline {
namespace {

constexpr int k_bin_count = 16;

/// Half the surface area: only ratios matter.
float half_area(const Aabb& box) {
  if (box.empty()) return 0.0f;
  const glm::vec3 e = box.extent();
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

struct Bin {
  Aabb box;
  std::uint32_t count = 0;
};

/// The bin boundary with the least expected cost, or 0 when every boundary leaves one side empty.
int cheapest_boundary(const std::array<Bin, k_bin_count>& bins) {
  std::array<float, k_bin_count> right_cost{};
  Bin right;
  for (int i = k_bin_count - 1; i > 0; --i) {
    right.box.add(bins[i].box);
    right.count += bins[i].count;
    right_cost[i] = half_area(right.box) * static_cast<float>(right.count);
  }
  Bin left;
  float best_cost = INFINITY;
  int best = 0;
  std::uint32_t total = right.count + bins[0].count;
  for (int i = 1; i < k_bin_count; ++i) {
    left.box.add(bins[i - 1].box);
    left.count += bins[i - 1].count;
    if (left.count == 0 || left.count == total) continue;
    const float cost = half_area(left.box) * static_cast<float>(left.count) + right_cost[i];
    if (cost < best_cost) {
      best_cost = cost;
      best = i;
    }
  }
  return best;
}

}  // namespace

void ObjectHierarchyBuilder::build() {
  make_items();
  const auto count = static_cast<std::uint32_t>(items_.size());
  hierarchy_.nodes_.clear();
  hierarchy_.leaf_of_.assign(count, 0);
  hierarchy_.order_.resize(count);
  if (count == 0) return;
  hierarchy_.nodes_.reserve(count);

  std::vector<Task> tasks{{0, count, 0, 0, false}};
  while (!tasks.empty()) {
    const Task task = tasks.back();
    tasks.pop_back();
    const auto node_index = static_cast<std::uint32_t>(hierarchy_.nodes_.size());
    hierarchy_.nodes_.push_back({{}, 0, task.parent, task.first, task.end});
    if (task.is_right) hierarchy_.nodes_[task.parent].right = node_index;
    const std::span<Item> items(items_.data() + task.first, task.end - task.first);
    if (items.size() <= k_max_leaf_objects) {
      make_leaf(node_index, items);
      continue;
    }
    const std::uint32_t middle = task.first + split(items, task.depth);
    // The left child is taken next, so that it follows its parent.
    tasks.push_back({middle, task.end, node_index, task.depth + 1, true});
    tasks.push_back({task.first, middle, node_index, task.depth + 1, false});
  }
  // Children lie behind their parents: one backward sweep unites all boxes.
  for (std::size_t i = hierarchy_.nodes_.size(); i-- > 1;) {
    hierarchy_.nodes_[hierarchy_.nodes_[i].parent].box.add(hierarchy_.nodes_[i].box);
  }
}

void ObjectHierarchyBuilder::make_items() {
  const std::vector<Aabb>& bounds = hierarchy_.bounds_;
  items_.resize(bounds.size());
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    glm::vec3 center = bounds[i].center();
    for (int axis = 0; axis < 3; ++axis) {
      if (!std::isfinite(center[axis])) center[axis] = 0.0f;  // an empty or unbounded box lies anywhere
    }
    items_[i] = {bounds[i], center, ObjectId{static_cast<std::uint32_t>(i)}};
  }
}

/// Reorders the items so that the first n belong left, and returns n, neither 0 nor all.
std::uint32_t ObjectHierarchyBuilder::split(std::span<Item> items, std::uint32_t depth) {
  const auto half = static_cast<std::uint32_t>(items.size() / 2);
  Aabb centers;
  for (const Item& item : items) centers.add(item.center);
  const glm::vec3 extent = centers.extent();
  const int axis = widest_axis(extent);
  const float scale = static_cast<float>(k_bin_count) / extent[axis];
  const auto by_center = [axis](const Item& a, const Item& b) { return a.center[axis] < b.center[axis]; };
  const auto halve = [&] {
    std::nth_element(items.begin(), items.begin() + half, items.end(), by_center);
    return half;
  };
  if (!std::isfinite(scale) || !std::isfinite(extent[axis])) return half;
  if (depth >= k_last_surface_depth) return halve();

  const float low = centers.min[axis];
  const auto bin_of = [=](const Item& item) {
    return std::min(k_bin_count - 1, static_cast<int>((item.center[axis] - low) * scale));
  };
  std::array<Bin, k_bin_count> bins;
  for (const Item& item : items) {
    Bin& bin = bins[static_cast<std::size_t>(bin_of(item))];
    bin.box.add(item.box);
    ++bin.count;
  }
  const int boundary = cheapest_boundary(bins);
  if (boundary == 0) return halve();
  const auto middle =
      std::partition(items.begin(), items.end(), [&](const Item& item) { return bin_of(item) < boundary; });
  return static_cast<std::uint32_t>(middle - items.begin());
}

void ObjectHierarchyBuilder::make_leaf(std::uint32_t node_index, std::span<const Item> items) {
  ObjectHierarchy::Node& node = hierarchy_.nodes_[node_index];
  std::uint32_t slot = node.first_slot;
  for (const Item& item : items) {
    node.box.add(item.box);
    hierarchy_.order_[slot++] = item.id;
    hierarchy_.leaf_of_[index_of(item.id)] = node_index;
  }
}

}  // namespace sightline
