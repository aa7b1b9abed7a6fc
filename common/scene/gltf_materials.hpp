#pragma once

#include <string>
#include <vector>

#include <glm/mat3x2.hpp>
#include <tiny_gltf.h>

#include "common/scene/gltf_accessors.hpp"
#include "common/scene/load_scene.hpp"
#include "common/scene/scene.hpp"

namespace sightline {

/// Which texture coordinates a material's base colour uses.
struct GltfTextureUse {
  int set = -1;        ///< TEXCOORD_n; -1 without a texture
  int transform = -1;  ///< of KHR_texture_transform, in GltfTextureSets::transforms; -1 without
};

struct GltfTextureSets {
  std::vector<GltfTextureUse> of_material;
  std::vector<glm::mat3x2> transforms;  ///< uv = transform * (u, v, 1); each different
};

/// Fills Scene::materials (same indices as the file) and the Scene::textures they need: with shading every
/// base colour texture, without only those of MASK materials. Metallic, normal and emissive maps hide nothing
/// and are not read. A material that lets light through (KHR_materials_transmission) counts as BLEND: it
/// never hides. KHR_texture_transform is read for the base colour, its override of the set included.
///
/// Throws InputError prefixed with `name` for a texture that cannot be decoded, more than 1 GiB of textures,
/// and a MASK material with a mirrored texture, whose holes a plain repeat would misplace (elsewhere a
/// mirrored repeat is drawn as a plain one).
GltfTextureSets add_gltf_materials(const tinygltf::Model& model, const GltfAccessors& accessors,
                                   const SceneLoadOptions& options, const std::string& name, Scene& scene);

}  // namespace sightline
