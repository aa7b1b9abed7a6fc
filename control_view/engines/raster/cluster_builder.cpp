#include "control_view/engines/raster/cluster_builder.hpp"

#include <algorithm>

#include "common/widest_axis.hpp"

namespace sightline::raster {
namespace {

/// The next multiple of k_padding, the gap filled with the last value.
template <class T>
void pad(std::vector<T>& values) {
  if (values.empty()) return;
  values.resize((values.size() + k_padding - 1) / k_padding * k_padding, values.back());
}

}  // namespace

ClusterBuilder::ClusterBuilder(const Scene& scene, bool with_uvs)
    : scene_(scene),
      with_uvs_(with_uvs),
      cluster_of_vertex_(scene.positions.size(), 0),
      local_of_vertex_(scene.positions.size(), 0) {}

std::uint32_t ClusterBuilder::add(const Primitive& primitive) {
  const auto before = clusters.size();
  triangles_.clear();
  for (std::uint32_t i = 0; i + 2 < primitive.index_count; i += 3) {
    const std::uint32_t* const index = scene_.indices.data() + primitive.first_index + i;
    const glm::vec3& a = scene_.positions[index[0]];
    const glm::vec3& b = scene_.positions[index[1]];
    const glm::vec3& c = scene_.positions[index[2]];
    if (a == b || b == c || c == a) continue;  // on screen without area too, for sure
    triangles_.push_back({{index[0], index[1], index[2]}, (a + b + c) * (1.0f / 3.0f)});
  }
  if (!triangles_.empty()) {
    const std::size_t count = triangles_.size();
    split(0, count, static_cast<std::uint32_t>((count + k_cluster_triangles - 1) / k_cluster_triangles));
  }
  return static_cast<std::uint32_t>(clusters.size() - before);
}

void ClusterBuilder::split(std::size_t first, std::size_t end, std::uint32_t parts) {
  if (parts == 1) return emit(first, end);
  Aabb centers;
  for (std::size_t i = first; i < end; ++i) centers.add(triangles_[i].center);
  const int axis = widest_axis(centers.extent());
  const std::uint32_t left_parts = parts / 2;
  const std::size_t middle = first + (end - first) * left_parts / parts;
  const auto begin = triangles_.begin();
  std::nth_element(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(middle),
                   begin + static_cast<std::ptrdiff_t>(end),
                   [axis](const Triangle& a, const Triangle& b) { return a.center[axis] < b.center[axis]; });
  split(first, middle, left_parts);
  split(middle, end, parts - left_parts);
}

void ClusterBuilder::emit(std::size_t first, std::size_t end) {
  clusters.emplace_back();
  const auto first_vertex = static_cast<std::uint32_t>(x.size());
  const auto first_triangle = static_cast<std::uint32_t>(corners[0].size());
  Aabb box;
  for (std::size_t i = first; i < end; ++i) {
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t vertex = triangles_[i].vertex[corner];
      corners[corner].push_back(local_vertex(vertex, first_vertex));
      box.add(scene_.positions[vertex]);
    }
  }
  clusters.back() = {box, first_vertex, first_triangle, static_cast<std::uint16_t>(x.size() - first_vertex),
                     static_cast<std::uint16_t>(end - first)};
  for (auto* coordinate : {&x, &y, &z, &u, &v}) pad(*coordinate);
  for (auto& corner : corners) pad(corner);
}

std::uint8_t ClusterBuilder::local_vertex(std::uint32_t global, std::uint32_t first_vertex) {
  const auto cluster = static_cast<std::uint32_t>(clusters.size());
  if (cluster_of_vertex_[global] != cluster) {
    cluster_of_vertex_[global] = cluster;
    local_of_vertex_[global] = static_cast<std::uint8_t>(x.size() - first_vertex);
    const glm::vec3& position = scene_.positions[global];
    x.push_back(position.x);
    y.push_back(position.y);
    z.push_back(position.z);
    if (with_uvs_) {
      u.push_back(scene_.uvs[global].x);
      v.push_back(scene_.uvs[global].y);
    }
  }
  return local_of_vertex_[global];
}

}  // namespace sightline::raster
