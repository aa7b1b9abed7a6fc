#pragma once

#include <string>
#include <vector>

#include <glm/mat4x4.hpp>
#include <tiny_gltf.h>

#include "common/scene/gltf_accessors.hpp"

namespace sightline {

/// One drawing of a mesh: a node with a mesh, or one instance of it.
struct GltfPlacement {
  int node = 0;
  int instance = -1;  ///< of EXT_mesh_gpu_instancing, otherwise -1
  int mesh = 0;
  glm::dmat4 world_from_object{1.0};
};

/// Walks the default scene (or the first, or without any every root) depth first, children in file order.
/// Matrices are composed in double. Throws InputError prefixed with `name` for a node or mesh that does not
/// exist, a node reached twice (a cycle, or two parents), an impossible transform, or more instances than the
/// file's bytes justify.
[[nodiscard]] std::vector<GltfPlacement> place_gltf_meshes(const tinygltf::Model& model,
                                                           const GltfAccessors& accessors,
                                                           const std::string& name);

}  // namespace sightline
