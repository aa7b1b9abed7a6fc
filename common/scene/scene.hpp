#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "common/bounds.hpp"
#include "common/object_id.hpp"
#include "common/scene_digest.hpp"

namespace sightline {

enum class AlphaMode : std::uint8_t { opaque, mask, blend };

inline constexpr std::uint32_t k_no_texture = 0xffffffffu;

struct Material {
  glm::vec4 base_color{1.0f};  ///< linear RGBA factor
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;  ///< mask: a fragment with alpha below it does not exist
  bool double_sided = false;  ///< otherwise back faces are culled
  std::uint32_t texture = k_no_texture;

  bool operator==(const Material&) const = default;
};

/// 8-bit RGBA, rows from the top (glTF's UV origin), sRGB colour with linear alpha.
struct Texture {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  bool repeat_u = true;
  bool repeat_v = true;
  std::vector<std::uint8_t> rgba;
};

/// A run of triangles with one material. Indices are into Scene's vertex arrays (no base vertex to add).
struct Primitive {
  std::uint32_t first_index = 0;
  std::uint32_t index_count = 0;  ///< a multiple of 3
  std::uint32_t material = 0;
};

/// Geometry in its own frame. Several objects may share one mesh (instances).
struct Mesh {
  std::uint32_t first_primitive = 0;
  std::uint32_t primitive_count = 0;
  Aabb bounds;  ///< of the vertices that the triangles use, mesh frame
};

struct Object {
  std::uint32_t mesh = 0;
  /// To the SCENE frame: world minus Scene::world_origin_m, so that floats suffice far from the world origin.
  glm::dmat4 scene_from_object{1.0};
};

/// All geometry of a scene in flat arrays. Vertices of all meshes lie one after another.
///
/// Frames: vertices are in mesh frame; objects place meshes in the scene frame, which is the world frame
/// moved by world_origin_m (zero unless the scene lies further than 1 km from the origin, then its rounded
/// centre). Right-handed, Y up, metres.
struct Scene {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;  ///< empty, or one a vertex; (0,0,0) where the file has none
  std::vector<glm::vec2> uvs;      ///< empty, or one a vertex
  std::vector<std::uint32_t> indices;
  std::vector<Primitive> primitives;
  std::vector<Mesh> meshes;
  std::vector<Material> materials;  ///< never empty
  std::vector<Texture> textures;
  std::vector<Object> objects;
  std::vector<std::string> object_names;  ///< empty, or one an object
  std::vector<Aabb> object_bounds;        ///< scene frame, one an object, conservative (see transformed())
  Aabb bounds;                            ///< of all objects, scene frame
  glm::dvec3 world_origin_m{0.0};
  SceneDigest digest{};

  [[nodiscard]] std::uint32_t object_count() const noexcept {
    return static_cast<std::uint32_t>(objects.size());
  }
  /// Triangles of one object, all its primitives.
  [[nodiscard]] std::uint64_t triangle_count(ObjectId id) const noexcept;
  /// Triangles of all objects (an instanced mesh counts once per instance).
  [[nodiscard]] std::uint64_t triangle_count() const noexcept;
  /// Bytes of the geometry arrays (positions, normals, uvs, indices).
  [[nodiscard]] std::size_t geometry_bytes() const noexcept;
};

/// Fills mesh bounds, object_bounds, bounds and digest from the rest, after moving the scene frame: where
/// world_origin_m is zero and the scene's centre lies further than 1 km from it on any axis, the origin
/// becomes the rounded centre. Adds a material where there is none. Loaders and generators call it last.
///
/// The digest covers what decides visibility: vertices, triangles, materials, transforms, object order, and
/// for textured MASK materials the texture and its coordinates. It is the same with and without what only
/// shading needs, and with and without meshes that no object uses.
///
/// Throws InputError (prefixed with `name`) when the scene breaks a rule above: an index out of range, a
/// non-finite vertex or transform, no object with a triangle, more than k_max_object_count objects, or
/// instances that draw more primitives than 2^24 plus one for each 12 bytes of geometry.
void finish_scene(Scene& scene, const std::string& name);

}  // namespace sightline
