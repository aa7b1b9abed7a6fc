#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include <glm/mat4x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "protocol/codec.hpp"

namespace sightline {

/// A scene as it crosses the wire: what decides visibility, and no more. World frame, right-handed, Y up,
/// metres; triangles are wound counter-clockwise seen from their front.
struct SceneData {
  /// A run of triangles of one material.
  struct Primitive {
    std::uint32_t first_index = 0;
    std::uint32_t index_count = 0;  ///< a multiple of 3
    std::uint32_t material = 0;
    bool operator==(const Primitive&) const = default;
  };
  /// Geometry in its own frame; objects share it.
  struct Mesh {
    std::uint32_t first_primitive = 0;
    std::uint32_t primitive_count = 0;
    bool operator==(const Mesh&) const = default;
  };
  enum class AlphaMode : std::uint8_t { opaque, mask, blend };
  struct Material {
    float base_alpha = 1.0f;
    float alpha_cutoff = 0.5f;  ///< mask: a fragment with alpha below it does not exist
    std::uint32_t texture = k_no_texture;
    AlphaMode alpha_mode = AlphaMode::opaque;
    bool double_sided = false;
    bool operator==(const Material&) const = default;
  };
  struct AlphaTexture {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    bool repeat_u = true;
    bool repeat_v = true;
    std::vector<std::uint8_t> alpha;  ///< rows from the top
    bool operator==(const AlphaTexture&) const = default;
  };
  struct Object {
    glm::dmat4x3 world_from_object{1.0};
    std::uint32_t mesh = 0;
    std::uint32_t flags = 0;  ///< of ObjectFlag
    std::uint32_t group = 0;  ///< levels of detail of one thing share it; 0: none
    bool operator==(const Object&) const = default;
  };
  static constexpr std::uint32_t k_no_texture = 0xffffffffu;

  std::vector<glm::vec3> positions;  ///< mesh frame
  std::vector<glm::vec2> uvs;        ///< empty, or one a vertex; (0, 0) is a texture's upper left corner
  std::vector<std::uint32_t> indices;
  std::vector<Primitive> primitives;
  std::vector<Mesh> meshes;
  std::vector<Material> materials;
  std::vector<AlphaTexture> alpha_textures;
  std::vector<Object> objects;
  std::uint32_t spare_objects = 0;  ///< ids without geometry after those of the objects

  bool operator==(const SceneData&) const = default;

  [[nodiscard]] std::uint64_t object_count() const noexcept { return objects.size() + spare_objects; }
  /// Of all objects: a shared mesh counts once for each.
  [[nodiscard]] std::uint64_t triangle_count() const;
};

/// What an object is to the visibility test. A bit each.
enum class ObjectFlag : std::uint32_t {
  hides_nothing = 1,    ///< tested, never an occluder: blended, or cut out by a texture that is not given
  occluder_only = 2,    ///< a proxy: hides what is behind it and is in no set
  casts_no_shadow = 4,  ///< neither hides nor is reported in a view for a shadow map
  always_visible = 8,   ///< the client draws it whatever the sets say; the daemon treats it as any other
};
inline constexpr std::uint32_t k_all_object_flags = 15;

[[nodiscard]] constexpr bool has(std::uint32_t flags, ObjectFlag flag) noexcept {
  return (flags & static_cast<std::uint32_t>(flag)) != 0;
}

/// One buffer of scene_data.fbs. The same scene gives the same bytes.
[[nodiscard]] std::vector<std::uint8_t> encode_scene_data(const SceneData& scene);

/// Safe on untrusted bytes: verified before any field is read. What it checks is the form (lists whole,
/// flags and modes known, textures as large as they say); that indices are in range and numbers finite is
/// for whoever makes a scene of it (finish_scene). Allocates no more than `bytes` are long, a few times.
/// Requires bytes aligned to 8. Throws only bad_alloc.
[[nodiscard]] std::variant<SceneData, DecodeError> decode_scene_data(std::span<const std::uint8_t> bytes);

}  // namespace sightline
