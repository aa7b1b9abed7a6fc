#include "control_view/engines/raster/nearest_first.hpp"

#include <algorithm>

#include <glm/geometric.hpp>

namespace sightline::raster {

void NearestFirst::sort(std::vector<std::uint32_t>& ranks, const glm::vec3& eye_m, const RasterScene& scene) {
  order_.clear();
  for (const std::uint32_t rank : ranks) {
    const RankOwner& owner = scene.owners[rank];
    const auto& columns = scene.placements[owner.object].columns;
    const glm::vec3 center = scene.clusters[owner.first_cluster].box.center();
    glm::vec3 offset = -eye_m;
    for (int row = 0; row < 3; ++row) {
      offset[row] += columns[0][row] * center.x + columns[1][row] * center.y + columns[2][row] * center.z +
                     columns[3][row];
    }
    const float squared = glm::dot(offset, offset);
    order_.emplace_back(squared >= 0.0f ? squared : 0.0f, rank);  // NaN has no place in an order
  }
  std::sort(order_.begin(), order_.end());
  for (std::size_t i = 0; i < order_.size(); ++i) ranks[i] = order_[i].second;
}

}  // namespace sightline::raster
