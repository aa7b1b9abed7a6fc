#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "common/object_hierarchy.hpp"
#include "control_view/engines/raster/raster_scene.hpp"

namespace sightline::raster {

/// Appends the objects of which anything may lie within `reach_m` of a point, scene frame: by the boxes of
/// their clusters, or by their own where a mesh is placed with a scale or a turn. Errs towards more.
void append_objects_near(const RasterScene& scene, const ObjectHierarchy& hierarchy, const glm::vec3& point_m,
                         float reach_m, std::vector<std::uint32_t>& objects);

}  // namespace sightline::raster
