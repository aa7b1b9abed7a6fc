#include "control_view/decode_scene.hpp"

#include <optional>
#include <unordered_map>
#include <utility>

namespace sightline {
namespace {

static_assert(SceneData::k_no_texture == k_no_texture);

Material material_of(const SceneData::Material& from) {
  Material material;
  material.base_color = {1.0f, 1.0f, 1.0f, from.base_alpha};
  material.alpha_mode = static_cast<AlphaMode>(from.alpha_mode);
  material.alpha_cutoff = from.alpha_cutoff;
  material.double_sided = from.double_sided;
  material.texture = from.texture;
  return material;
}

Texture texture_of(const SceneData::AlphaTexture& from) {
  Texture texture{from.width, from.height, from.repeat_u, from.repeat_v, {}};
  texture.rgba.reserve(4 * from.alpha.size());
  for (const std::uint8_t alpha : from.alpha) texture.rgba.insert(texture.rgba.end(), {255, 255, 255, alpha});
  return texture;
}

/// The same triangles, none of which hides anything.
class BlendedCopies {
 public:
  explicit BlendedCopies(Scene& scene) : scene_(scene) {}

  std::uint32_t of_mesh(std::uint32_t mesh) {
    // What does not exist is for finish_scene to refuse.
    if (mesh >= scene_.meshes.size()) return mesh;
    const auto [copy, is_new] = meshes_.try_emplace(mesh, 0);
    if (!is_new) return copy->second;
    const Mesh from = scene_.meshes[mesh];
    const std::uint64_t end = std::uint64_t{from.first_primitive} + from.primitive_count;
    if (end > scene_.primitives.size()) return copy->second = mesh;
    Mesh blended;
    blended.first_primitive = static_cast<std::uint32_t>(scene_.primitives.size());
    blended.primitive_count = from.primitive_count;
    for (std::uint64_t i = from.first_primitive; i < end; ++i) {
      Primitive primitive = scene_.primitives[i];
      primitive.material = of_material(primitive.material);
      scene_.primitives.push_back(primitive);
    }
    scene_.meshes.push_back(blended);
    return copy->second = static_cast<std::uint32_t>(scene_.meshes.size() - 1);
  }

 private:
  std::uint32_t of_material(std::uint32_t material) {
    if (material >= scene_.materials.size()) return material;
    const auto [copy, is_new] = materials_.try_emplace(material, 0);
    if (!is_new) return copy->second;
    Material blended = scene_.materials[material];
    blended.alpha_mode = AlphaMode::blend;
    scene_.materials.push_back(blended);
    return copy->second = static_cast<std::uint32_t>(scene_.materials.size() - 1);
  }

  Scene& scene_;
  std::unordered_map<std::uint32_t, std::uint32_t> meshes_, materials_;
};

}  // namespace

std::string excess_of(const SceneData& data) {
  std::uint64_t primitives = 0, indices = 0;
  for (const SceneData::Mesh& mesh : data.meshes) primitives += mesh.primitive_count;
  for (const SceneData::Primitive& primitive : data.primitives) indices += primitive.index_count;
  if (primitives > k_most_uses * data.primitives.size()) {
    return "meshes: they name " + std::to_string(primitives) + " primitives, there are " +
           std::to_string(data.primitives.size());
  }
  if (indices > k_most_uses * data.indices.size()) {
    return "primitives: they name " + std::to_string(indices) + " indices, there are " +
           std::to_string(data.indices.size());
  }
  return {};
}

Scene scene_of(SceneData data, const std::string& name) {
  Scene scene;
  scene.positions = std::move(data.positions);
  scene.uvs = std::move(data.uvs);
  scene.indices = std::move(data.indices);
  for (const SceneData::Primitive& primitive : data.primitives)
    scene.primitives.push_back({primitive.first_index, primitive.index_count, primitive.material});
  for (const SceneData::Mesh& mesh : data.meshes)
    scene.meshes.push_back({mesh.first_primitive, mesh.primitive_count, {}});
  for (const SceneData::Material& material : data.materials) scene.materials.push_back(material_of(material));
  if (scene.materials.empty()) scene.materials.emplace_back();
  for (const SceneData::AlphaTexture& texture : data.alpha_textures)
    scene.textures.push_back(texture_of(texture));

  BlendedCopies blended(scene);
  scene.objects.reserve(data.object_count());
  for (const SceneData::Object& object : data.objects) {
    const bool hides = !has(object.flags, ObjectFlag::hides_nothing) && object.group == 0;
    scene.objects.push_back(
        {hides ? object.mesh : blended.of_mesh(object.mesh), glm::dmat4(object.world_from_object)});
  }
  if (data.spare_objects > 0) {
    scene.meshes.emplace_back();
    const auto empty = static_cast<std::uint32_t>(scene.meshes.size() - 1);
    scene.objects.resize(data.object_count(), Object{empty, glm::dmat4(1.0)});
  }
  finish_scene(scene, name);
  return scene;
}

}  // namespace sightline
