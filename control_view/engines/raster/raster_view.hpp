#pragma once

#include <glm/vec3.hpp>

#include "common/view.hpp"
#include "control_view/engines/raster/kernel.hpp"

namespace sightline::raster {

/// An eye's view of an image, for kernels. Scene frame: the world's, moved by `world_origin_m`.
[[nodiscard]] RasterView view_of(const Eye& eye, const glm::dvec3& world_origin_m, ImageSize image);

}  // namespace sightline::raster
