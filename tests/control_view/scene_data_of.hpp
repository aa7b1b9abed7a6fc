#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "common/scene/scene.hpp"
#include "protocol/scene_chunks.hpp"
#include "protocol/scene_data.hpp"

namespace sightline::test {

/// A scene as a client would describe it. Its textures become alpha textures.
inline SceneData scene_data_of(const Scene& scene) {
  SceneData data;
  data.positions = scene.positions;
  data.uvs = scene.uvs;
  data.indices = scene.indices;
  for (const Primitive& p : scene.primitives)
    data.primitives.push_back({p.first_index, p.index_count, p.material});
  for (const Mesh& mesh : scene.meshes) data.meshes.push_back({mesh.first_primitive, mesh.primitive_count});
  for (const Material& m : scene.materials) {
    data.materials.push_back({m.base_color.w, m.alpha_cutoff, m.texture,
                              static_cast<SceneData::AlphaMode>(m.alpha_mode), m.double_sided});
  }
  for (const Texture& texture : scene.textures) {
    SceneData::AlphaTexture alpha{texture.width, texture.height, texture.repeat_u, texture.repeat_v, {}};
    for (std::size_t i = 3; i < texture.rgba.size(); i += 4) alpha.alpha.push_back(texture.rgba[i]);
    data.alpha_textures.push_back(std::move(alpha));
  }
  for (const Object& object : scene.objects) {
    SceneData::Object placed;
    placed.world_from_object = glm::dmat4x3(object.scene_from_object);
    placed.world_from_object[3] += scene.world_origin_m;
    placed.mesh = object.mesh;
    data.objects.push_back(placed);
  }
  return data;
}

/// What a client has to send.
struct Parcel {
  std::vector<std::uint8_t> bytes;
  SceneOffer offer;

  explicit Parcel(const SceneData& data)
      : bytes(encode_scene_data(data)),
        offer(offer_of(bytes, static_cast<std::uint32_t>(data.object_count()), data.triangle_count())) {}

  [[nodiscard]] SceneChunk chunk(std::uint32_t index) const {
    const auto part = chunk_of(bytes, index);
    return {offer.scene_digest, index, {part.begin(), part.end()}};
  }
  [[nodiscard]] std::uint32_t chunk_count() const {
    return static_cast<std::uint32_t>(offer.chunk_digests.size());
  }
};

}  // namespace sightline::test
