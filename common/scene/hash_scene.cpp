#include "common/scene/hash_scene.hpp"

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>
#include <span>
#include <vector>

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

constexpr std::uint32_t k_unused = 0xffffffffu;

/// Place of each mesh among those that objects use.
std::vector<std::uint32_t> number_used_meshes(const Scene& scene) {
  std::vector<std::uint32_t> number(scene.meshes.size(), k_unused);
  for (const Object& object : scene.objects) number[object.mesh] = 0;
  std::uint32_t next = 0;
  for (std::uint32_t& place : number) {
    if (place != k_unused) place = next++;
  }
  return number;
}

}  // namespace

SceneDigest hash_scene(const Scene& scene) {
  Hasher hasher;
  hasher.add(static_cast<std::uint64_t>(scene.positions.size()));
  hasher.add(std::span<const glm::vec3>(scene.positions));
  hasher.add(static_cast<std::uint64_t>(scene.materials.size()));
  for (const Material& material : scene.materials) add_material(hasher, scene, material);
  // A mesh that no object uses hides nothing, and a loader does not read it: the used ones count, from 0.
  const std::vector<std::uint32_t> number = number_used_meshes(scene);
  hasher.add(static_cast<std::uint64_t>(
      std::count_if(number.begin(), number.end(), [](std::uint32_t mesh) { return mesh != k_unused; })));
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    if (number[m] == k_unused) continue;
    const Mesh& mesh = scene.meshes[m];
    hasher.add(mesh.primitive_count);
    for (std::uint32_t i = 0; i < mesh.primitive_count; ++i) {
      add_primitive(hasher, scene, scene.primitives[mesh.first_primitive + i]);
    }
  }
  hasher.add(static_cast<std::uint64_t>(scene.objects.size()));
  for (const Object& object : scene.objects) {
    hasher.add(number[object.mesh]);
    hasher.add(object.scene_from_object);
  }
  hasher.add(scene.world_origin_m);
  return hasher.digest();
}

}  // namespace sightline
