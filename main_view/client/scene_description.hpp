#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/mat4x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "main_view/client/scene_objects.hpp"
#include "protocol/messages.hpp"
#include "protocol/scene_data.hpp"

namespace sightline {

enum class MeshId : std::uint32_t {};
enum class MaterialId : std::uint32_t {};
enum class AlphaTextureId : std::uint32_t {};
inline constexpr AlphaTextureId k_no_alpha_texture{SceneData::k_no_texture};

/// What of a material decides visibility; colours do not.
struct MaterialDescription {
  SceneData::AlphaMode alpha_mode = SceneData::AlphaMode::opaque;
  float base_alpha = 1.0f;    ///< 0 to 1; times the texture's
  float alpha_cutoff = 0.5f;  ///< mask: a fragment with alpha below it does not exist
  AlphaTextureId alpha_texture = k_no_alpha_texture;
  bool double_sided = false;  ///< otherwise triangles are seen only where they run counter-clockwise
};

/// 8 bits a texel, rows from the top: texture coordinate (0, 0) is the first texel's corner.
struct AlphaTextureDescription {
  std::uint32_t width = 0, height = 0;
  std::span<const std::uint8_t> alpha;
  bool repeat_u = true, repeat_v = true;
};

/// A run of a mesh's indices with one material.
struct MeshPart {
  std::uint32_t first_index = 0;
  std::uint32_t index_count = 0;  ///< a multiple of 3
  MaterialId material{};
};

/// A scene packed as the wire has it, with its digest: what a client uploads where the daemon lacks it.
/// Never changes; clients of one process share it.
struct PackedScene {
  std::vector<std::uint8_t> bytes;  ///< protocol/scene_data.hpp
  SceneOffer offer;
  SceneObjects objects;
};

/// A scene as an application describes it, piece by piece. What is added is copied at once.
///
/// Every call throws InputError for what breaks a rule (an index out of range, a number that is not finite,
/// an id that was not given out here) and has changed nothing then.
class SceneDescription {
 public:
  /// Material 0 exists from the start: opaque, single-sided.
  SceneDescription();

  MaterialId add_material(const MaterialDescription& material);
  AlphaTextureId add_alpha_texture(const AlphaTextureDescription& texture);

  /// Triangles in the mesh's own frame, metres. `indices` are into `positions`; `uvs` is empty or has one a
  /// vertex, needed where a part's material is alpha-tested with a texture.
  MeshId add_mesh(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                  MaterialId material = {}, std::span<const glm::vec2> uvs = {});
  MeshId add_mesh(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                  std::span<const MeshPart> parts, std::span<const glm::vec2> uvs = {});

  /// Places a mesh; any number of objects may share one. Ids run 0, 1, 2 ... in the order of the calls.
  /// `flags`: bits of ObjectFlag. `group`: see SceneObject.
  ObjectId add_object(MeshId mesh, const glm::dmat4x3& world_from_object, std::uint32_t flags = 0,
                      std::uint32_t group = 0);
  /// Ids without geometry behind all others, for objects that are added while the daemon runs.
  void set_spare_objects(std::uint32_t count);

  /// Spare ones left out.
  [[nodiscard]] std::uint32_t object_count() const noexcept {
    return static_cast<std::uint32_t>(scene_.objects.size());
  }
  /// Of all objects; an instance counts again.
  [[nodiscard]] std::uint64_t triangle_count() const noexcept { return triangle_count_; }

  /// Packs the scene and takes its digest; the description is empty afterwards. Throws InputError for a
  /// scene without a triangle. Cost: a pass over the bytes, about a second a gigabyte.
  [[nodiscard]] std::shared_ptr<const PackedScene> pack();

 private:
  void require_room(std::size_t more_bytes);

  SceneData scene_;
  std::vector<Aabb> mesh_bounds_;  ///< of the vertices that the triangles use
  std::vector<std::uint64_t> mesh_triangles_;
  std::uint64_t triangle_count_ = 0;
  std::size_t byte_count_ = 0;  ///< of what was added; the packed scene is a little larger
};

}  // namespace sightline
