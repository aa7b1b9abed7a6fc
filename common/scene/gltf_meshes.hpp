#pragma once

#include <span>
#include <string>
#include <vector>

#include <tiny_gltf.h>

#include "common/scene/gltf_accessors.hpp"
#include "common/scene/gltf_materials.hpp"
#include "common/scene/load_scene.hpp"
#include "common/scene/scene.hpp"

namespace sightline {

/// Appends the geometry of the meshes marked in `used` to `scene`, in file order, and returns each one's
/// index in Scene::meshes (meaningless for the others). Vertices that several primitives take from the same
/// accessors are read once, and KHR_texture_transform is applied to their coordinates. Points and lines are
/// dropped; strips, fans and non-indexed primitives become indexed triangles; an incomplete last triangle is
/// dropped, as a renderer would. Throws InputError prefixed with `name` for an accessor that lies, an index
/// out of range, more vertices or indices than the file's bytes justify, or a COLOR_0 alpha below 1 on a MASK
/// material (vertex colours are not read otherwise).
std::vector<std::uint32_t> add_gltf_meshes(const tinygltf::Model& model, const GltfAccessors& accessors,
                                           const std::vector<bool>& used, const GltfTextureSets& sets,
                                           const SceneLoadOptions& options, const std::string& name,
                                           Scene& scene);

}  // namespace sightline
