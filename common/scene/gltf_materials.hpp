#pragma once

#include <string>

#include <tiny_gltf.h>

#include "common/scene/gltf_accessors.hpp"
#include "common/scene/load_scene.hpp"
#include "common/scene/scene.hpp"

namespace sightline {

/// Which texture coordinate set (TEXCOORD_n) each material's base colour uses, -1 without a texture.
struct GltfTextureSets {
  std::vector<int> set_of_material;
};

/// Fills Scene::materials (same indices as the file) and the Scene::textures they need: with shading every
/// base colour texture, without only those of MASK materials. Metallic, normal and emissive maps hide nothing
/// and are not read. A material that lets light through (KHR_materials_transmission) counts as BLEND: it
/// never hides. Throws InputError prefixed with `name` for a texture that cannot be decoded.
GltfTextureSets add_gltf_materials(const tinygltf::Model& model, const GltfAccessors& accessors,
                                   const SceneLoadOptions& options, const std::string& name, Scene& scene);

}  // namespace sightline
