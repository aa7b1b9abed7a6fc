#pragma once

#include <cmath>
#include <initializer_list>
#include <memory>
#include <random>
#include <vector>

#include "common/pose.hpp"
#include "common/view.hpp"
#include "main_view/client/client_view.hpp"
#include "main_view/client/scene_description.hpp"
#include "protocol/visible_set.hpp"

namespace sightline::testing {

inline glm::dmat4x3 placed_at(const glm::dvec3& position_m) {
  glm::dmat4x3 matrix(1.0);
  matrix[3] = position_m;
  return matrix;
}

inline const Aabb k_unit_box{glm::vec3(-0.5f), glm::vec3(0.5f)};

/// A cube of a metre about the mesh's origin.
inline MeshId add_cube(SceneDescription& scene, MaterialId material = {}) {
  std::vector<glm::vec3> positions;
  for (int i = 0; i < 8; ++i)
    positions.emplace_back(i & 1 ? 0.5f : -0.5f, i & 2 ? 0.5f : -0.5f, i & 4 ? 0.5f : -0.5f);
  const std::vector<std::uint32_t> indices{0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                           2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  return scene.add_mesh(positions, indices, material);
}

/// Objects of a metre, strewn over `side_m` about the origin.
inline SceneObjects strewn_objects(std::uint32_t count, float side_m, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-0.5 * side_m, 0.5 * side_m);
  SceneObjects scene;
  scene.digest = {1, 2, 3};
  for (std::uint32_t i = 0; i < count; ++i) {
    SceneObject object;
    object.object_bounds = k_unit_box;
    object.world_from_object = placed_at({place(random), place(random), place(random)});
    scene.objects.push_back(object);
  }
  return scene;
}

inline VisibleSet set_of(std::initializer_list<std::uint32_t> indices) {
  std::vector<ObjectId> ids;
  for (const std::uint32_t index : indices) ids.push_back(ObjectId{index});
  return VisibleSet(ids);
}

/// A view from `position_m`, turned by `yaw_rad` from -Z to the left.
inline ViewPose view_pose(ViewId view, const glm::dvec3& position_m, double yaw_rad = 0.0) {
  const Pose pose{position_m, {std::cos(0.5 * yaw_rad), 0.0, std::sin(0.5 * yaw_rad), 0.0}};
  return {view, camera_from_world(pose), clip_from_camera(Perspective{}, 4.0 / 3.0)};
}

}  // namespace sightline::testing
