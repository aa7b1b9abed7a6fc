#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "common/scene/scene.hpp"
#include "main_view/client/scene_description.hpp"

namespace sightline::testing {

/// A loaded scene as an application would describe it, mesh by mesh. Object ids are the scene's.
inline SceneDescription describe(const Scene& scene) {
  SceneDescription description;
  std::vector<AlphaTextureId> textures;
  for (const Texture& texture : scene.textures) {
    std::vector<std::uint8_t> alpha;
    for (std::size_t i = 3; i < texture.rgba.size(); i += 4) alpha.push_back(texture.rgba[i]);
    textures.push_back(description.add_alpha_texture(
        {texture.width, texture.height, alpha, texture.repeat_u, texture.repeat_v}));
  }
  std::vector<MaterialId> materials;
  for (const Material& material : scene.materials) {
    materials.push_back(description.add_material(
        {static_cast<SceneData::AlphaMode>(material.alpha_mode), material.base_color.w, material.alpha_cutoff,
         material.texture == k_no_texture ? k_no_alpha_texture : textures[material.texture],
         material.double_sided}));
  }
  for (const Mesh& mesh : scene.meshes) {
    std::vector<std::uint32_t> indices;
    std::vector<MeshPart> parts;
    std::uint32_t first = std::numeric_limits<std::uint32_t>::max(), last = 0;
    for (std::uint32_t p = 0; p < mesh.primitive_count; ++p) {
      const Primitive& primitive = scene.primitives[mesh.first_primitive + p];
      const auto run = std::span(scene.indices).subspan(primitive.first_index, primitive.index_count);
      parts.push_back(
          {static_cast<std::uint32_t>(indices.size()), primitive.index_count, materials[primitive.material]});
      indices.insert(indices.end(), run.begin(), run.end());
      for (const std::uint32_t index : run) {
        first = std::min(first, index);
        last = std::max(last, index);
      }
    }
    if (indices.empty()) {
      description.add_mesh({}, {}, std::span<const MeshPart>());
      continue;
    }
    for (std::uint32_t& index : indices) index -= first;
    const std::size_t count = std::size_t{last} - first + 1;
    const auto positions = std::span(scene.positions).subspan(first, count);
    const auto uvs =
        scene.uvs.empty() ? std::span<const glm::vec2>() : std::span(scene.uvs).subspan(first, count);
    description.add_mesh(positions, indices, parts, uvs);
  }
  for (const Object& object : scene.objects) {
    glm::dmat4x3 world_from_object(object.scene_from_object);
    world_from_object[3] += scene.world_origin_m;
    description.add_object(MeshId{object.mesh}, world_from_object);
  }
  return description;
}

}  // namespace sightline::testing
