#pragma once

#include <cstdint>
#include <vector>

#include "control_view/engines/raster/raster_scene.hpp"

namespace sightline::raster {

/// Cuts primitives into clusters: balanced median cuts along the widest axis of the triangles' centres, until
/// no part holds more than k_cluster_triangles. Several builders may work on one scene, each with its own
/// output.
class ClusterBuilder {
 public:
  explicit ClusterBuilder(const Scene& scene, bool with_uvs);

  /// Appends the clusters of one primitive; returns how many.
  std::uint32_t add(const Primitive& primitive);

  std::vector<float> x, y, z, u, v;
  std::vector<std::uint8_t> corners[3];
  std::vector<Cluster> clusters;

 private:
  struct Triangle {
    std::uint32_t vertex[3];
    glm::vec3 center;
  };

  void split(std::size_t first, std::size_t end, std::uint32_t parts);
  void emit(std::size_t first, std::size_t end);
  std::uint8_t local_vertex(std::uint32_t global, std::uint32_t first_vertex);

  const Scene& scene_;
  bool with_uvs_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t>
      cluster_of_vertex_;  ///< by global vertex: the cluster it was last put into, from 1
  std::vector<std::uint8_t> local_of_vertex_;
};

}  // namespace sightline::raster
