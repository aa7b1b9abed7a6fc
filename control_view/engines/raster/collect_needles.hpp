#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "common/scene/scene.hpp"
#include "control_view/engines/raster/needle.hpp"

namespace sightline::raster {

/// In the mesh frame.
[[nodiscard]] std::array<glm::vec3, 3> corners_of(const Scene& scene, const MeshTriangle& triangle);

/// The triangles that some object of the scene has as a needle, each once, and the needles: see NeedleIndex.
/// Of more than `most` the thinnest.
[[nodiscard]] std::pair<std::vector<MeshTriangle>, std::vector<Needle>> collect_needles(const Scene& scene,
                                                                                        std::size_t most);

}  // namespace sightline::raster
