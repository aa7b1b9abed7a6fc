#include "common/scene/gltf_loader.hpp"

#include "common/scene/gltf_accessors.hpp"
#include "common/scene/gltf_materials.hpp"
#include "common/scene/gltf_meshes.hpp"
#include "common/scene/gltf_model.hpp"
#include "common/scene/gltf_nodes.hpp"

namespace sightline {
namespace {

std::string object_name(const tinygltf::Model& model, const GltfPlacement& placement) {
  std::string name = model.nodes[static_cast<std::size_t>(placement.node)].name;
  if (name.empty()) name.append("node ").append(std::to_string(placement.node));
  if (placement.instance >= 0) name.append("[").append(std::to_string(placement.instance)).append("]");
  return name;
}

Scene build_scene(const tinygltf::Model& model, const SceneLoadOptions& options, const std::string& name) {
  Scene scene;
  const GltfAccessors accessors(model, name);
  const std::vector<GltfPlacement> placements = place_gltf_meshes(model, accessors, name);
  std::vector<bool> used(model.meshes.size(), false);
  for (const GltfPlacement& placement : placements) used[static_cast<std::size_t>(placement.mesh)] = true;

  const GltfTextureSets sets = add_gltf_materials(model, accessors, options, name, scene);
  const std::vector<std::uint32_t> mesh_index =
      add_gltf_meshes(model, accessors, used, sets, options, name, scene);
  scene.objects.reserve(placements.size());
  if (options.shading) scene.object_names.reserve(placements.size());
  for (const GltfPlacement& placement : placements) {
    scene.objects.push_back(
        {mesh_index[static_cast<std::size_t>(placement.mesh)], placement.world_from_object});
    if (options.shading) scene.object_names.push_back(object_name(model, placement));
  }
  return scene;
}

}  // namespace

Scene load_gltf(const std::filesystem::path& file, const SceneLoadOptions& options) {
  const std::string name = file.string();
  Scene scene = build_scene(parse_gltf(file), options, name);  // the model and its buffers die here
  finish_scene(scene, name);
  return scene;
}

}  // namespace sightline
