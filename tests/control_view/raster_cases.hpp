#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/scene/scene.hpp"
#include "common/view.hpp"

namespace sightline::test {

/// One picture that a rasterizer of ids must get right.
struct RasterCase {
  std::string name;
  Scene scene;
  Eye eye;
  ImageSize size;
};

/// Adversarial pictures, the same for the same seed and compiler: soups of triangles, slivers, shared edges,
/// triangles that are huge, tiny, degenerate, coplanar, behind the eye or through the near plane, mirrored,
/// alpha-tested and blended objects, and projections that are off-axis, parallel or without a far plane.
/// Small images, so that all of them together take little time.
[[nodiscard]] std::vector<RasterCase> raster_cases(std::uint32_t seed);

}  // namespace sightline::test
