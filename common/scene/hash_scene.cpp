#include "common/scene/hash_scene.hpp"

#include <cstring>
#include <memory>
#include <new>
#include <span>

#include <xxhash.h>

namespace sightline {
namespace {

class Hasher {
 public:
  Hasher() : state_(XXH3_createState(), &XXH3_freeState) {
    if (!state_) throw std::bad_alloc();
    XXH3_128bits_reset(state_.get());
  }

  template <class T>
  void add(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    XXH3_128bits_update(state_.get(), values.data(), values.size_bytes());
  }
  /// Only for types without padding: its bytes would be hashed too.
  template <class T>
  void add(const T& value) {
    add(std::span<const T>(&value, 1));
  }

  [[nodiscard]] SceneDigest digest() const {
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(state_.get()));
    SceneDigest digest{};
    static_assert(sizeof(canonical.digest) == sizeof(digest));
    std::memcpy(digest.data(), canonical.digest, digest.size());
    return digest;
  }

 private:
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_;
};

bool cuts_holes(const Material& material) {
  return material.alpha_mode == AlphaMode::mask && material.texture != k_no_texture;
}

void add_material(Hasher& hasher, const Scene& scene, const Material& material) {
  hasher.add(material.base_color);
  hasher.add(static_cast<std::uint8_t>(material.alpha_mode));
  hasher.add(static_cast<std::uint8_t>(material.double_sided));
  hasher.add(material.alpha_cutoff);
  hasher.add(static_cast<std::uint8_t>(cuts_holes(material)));
  if (!cuts_holes(material)) return;
  const Texture& texture = scene.textures[material.texture];
  hasher.add(texture.width);
  hasher.add(texture.height);
  hasher.add(static_cast<std::uint8_t>(texture.repeat_u));
  hasher.add(static_cast<std::uint8_t>(texture.repeat_v));
  hasher.add(std::span<const std::uint8_t>(texture.rgba));
}

void add_primitive(Hasher& hasher, const Scene& scene, const Primitive& primitive) {
  hasher.add(primitive.index_count);
  hasher.add(primitive.material);
  const auto indices =
      std::span<const std::uint32_t>(scene.indices).subspan(primitive.first_index, primitive.index_count);
  hasher.add(indices);
  if (!cuts_holes(scene.materials[primitive.material])) return;
  for (const std::uint32_t index : indices) {
    hasher.add(scene.uvs.empty() ? glm::vec2(0.0f) : scene.uvs[index]);
  }
}

}  // namespace

SceneDigest hash_scene(const Scene& scene) {
  Hasher hasher;
  hasher.add(static_cast<std::uint64_t>(scene.positions.size()));
  hasher.add(std::span<const glm::vec3>(scene.positions));
  hasher.add(static_cast<std::uint64_t>(scene.materials.size()));
  for (const Material& material : scene.materials) add_material(hasher, scene, material);
  hasher.add(static_cast<std::uint64_t>(scene.meshes.size()));
  for (const Mesh& mesh : scene.meshes) {
    hasher.add(mesh.primitive_count);
    for (std::uint32_t i = 0; i < mesh.primitive_count; ++i) {
      add_primitive(hasher, scene, scene.primitives[mesh.first_primitive + i]);
    }
  }
  hasher.add(static_cast<std::uint64_t>(scene.objects.size()));
  for (const Object& object : scene.objects) {
    hasher.add(object.mesh);
    hasher.add(object.scene_from_object);
  }
  hasher.add(scene.world_origin_m);
  return hasher.digest();
}

}  // namespace sightline
