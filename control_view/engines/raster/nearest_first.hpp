#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "control_view/engines/raster/raster_scene.hpp"

namespace sightline::raster {

/// Sorts ranks by how far the middle of their cluster lies from the eye. Middles rather than nearest points:
/// large surfaces that reach under the eye, such as a ground, then come after what stands on them.
class NearestFirst {
 public:
  /// `eye_m` in the scene frame.
  void sort(std::vector<std::uint32_t>& ranks, const glm::vec3& eye_m, const RasterScene& scene);

 private:
  std::vector<std::pair<float, std::uint32_t>> order_;
};

}  // namespace sightline::raster
