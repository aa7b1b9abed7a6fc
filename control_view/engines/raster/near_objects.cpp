#include "control_view/engines/raster/near_objects.hpp"

#include <algorithm>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace sightline::raster {
namespace {

/// NaN and empty boxes are not near.
bool is_near(const Aabb& box, const glm::vec3& point_m, float reach_m) {
  const glm::vec3 outside = glm::max(glm::max(box.min - point_m, point_m - box.max), glm::vec3(0.0f));
  return glm::length(outside) <= reach_m;
}

bool any_cluster_near(const RasterScene& scene, std::uint32_t object, const glm::vec3& point_m,
                      float reach_m) {
  if (!scene.placements[object].identity) return true;
  for (std::uint32_t i = scene.first_item[object]; i < scene.first_item[object + 1]; ++i) {
    const Item& item = scene.items[i];
    for (std::uint32_t cluster = item.first_cluster; cluster < item.end_cluster; ++cluster) {
      if (is_near(scene.clusters[cluster].box, point_m, reach_m)) return true;
    }
  }
  return false;
}

}  // namespace

void append_objects_near(const RasterScene& scene, const ObjectHierarchy& hierarchy, const glm::vec3& point_m,
                         float reach_m, std::vector<std::uint32_t>& objects) {
  const auto nodes = hierarchy.nodes();
  if (nodes.empty()) return;
  std::vector<std::uint32_t> stack{0};
  while (!stack.empty()) {
    const std::uint32_t index = stack.back();
    stack.pop_back();
    const ObjectHierarchy::Node& node = nodes[index];
    if (!is_near(node.box, point_m, reach_m)) continue;
    if (!node.is_leaf()) {
      stack.push_back(node.right);
      stack.push_back(index + 1);
      continue;
    }
    for (const ObjectId id : hierarchy.objects_of(node)) {
      const std::uint32_t object = index_of(id);
      const bool near = is_near(hierarchy.bounds_of(id), point_m, reach_m);
      if (near && any_cluster_near(scene, object, point_m, reach_m)) objects.push_back(object);
    }
  }
}

}  // namespace sightline::raster
