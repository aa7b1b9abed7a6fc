#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>

#include "common/gl/object.hpp"
#include "common/scene/scene.hpp"
#include "common/view.hpp"

namespace sightline::gl {

/// Which of an object's primitives a pass draws: those that hide (opaque and mask) or those that never do.
enum class Layer : std::uint8_t { opaque, blended };

/// The one order, or the same backwards: for a pass whose depth test lets the last of two coincident surfaces
/// win, so that the first in the one order still does.
enum class DrawOrder : std::uint8_t { forward, backward };

struct DrawStats {
  std::uint32_t objects = 0;  ///< that had something to draw in the layer
  std::uint64_t triangles = 0;

  DrawStats& operator+=(const DrawStats& other) noexcept {
    objects += other.objects;
    triangles += other.triangles;
    return *this;
  }
};

/// Where an object's opaque primitives stand in the one order. Of two coincident surfaces the lower position
/// wins; objects whose ranges overlap take turns, and then only drawing tells.
struct DrawPositions {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
};

/// The programs of a pass. `mask` is for materials with an alpha test; a pass that has none uses one program
/// twice. Kept apart because a shader that may discard loses the early depth test for every fragment.
struct PassPrograms {
  GLuint solid = 0;
  GLuint mask = 0;
};

/// A scene's geometry on the GPU, and the one order in which everybody draws it.
///
/// Why one order: where two surfaces coincide, the first drawn wins the depth test. The control view, the
/// audit and the renderer therefore draw the same sequence, so that leaving hidden objects out never changes
/// who wins.
///
/// Vertex inputs and storage blocks are those of k_transform_glsl.
class GpuScene {
 public:
  /// Uploads. `with_shading` adds normals, uvs of every material and all textures; otherwise uvs and textures
  /// are there for mask materials only. `scene` may be destroyed afterwards. Throws MachineError out of
  /// memory.
  GpuScene(const Scene& scene, bool with_shading);

  /// Sets the placement of objects, scene frame. Cost follows their number.
  void set_transforms(std::span<const ObjectId> ids, std::span<const glm::dmat4> scene_from_object);

  /// Draws one layer of `ids` (ascending). Sets program, culling, winding and texture unit 0; colour, depth,
  /// stencil and blend state and the programs' own uniforms are the caller's. A program's uniform
  /// `u_textured` (int), where it has one, says whether unit 0 holds the material's texture.
  DrawStats draw(Layer layer, std::span<const ObjectId> ids, const PassPrograms& programs,
                 DrawOrder order = DrawOrder::forward);

  /// Of an object that has an opaque layer, as it is placed now.
  [[nodiscard]] DrawPositions opaque_positions(ObjectId id) const noexcept;

  [[nodiscard]] std::uint32_t object_count() const noexcept {
    return static_cast<std::uint32_t>(first_item_.size()) - 1;
  }
  [[nodiscard]] bool has_layer(Layer layer, ObjectId id) const noexcept;
  /// Triangles of both layers.
  [[nodiscard]] std::uint64_t triangle_count(ObjectId id) const noexcept;
  [[nodiscard]] const glm::dvec3& world_origin_m() const noexcept { return world_origin_m_; }

 private:
  /// One primitive of one object: one indirect draw, whose base instance is the item's own index.
  struct DrawItem {
    std::uint32_t first_index;
    std::uint32_t index_count;
    std::uint32_t texture;
    Layer layer;
    std::uint8_t sides_and_mask;  ///< bits of the draw group that the material decides
  };
  struct DrawCommand {
    std::uint32_t count, instance_count, first_index, base_vertex, base_instance;
  };
  /// The four columns of an affine placement, one a draw item. A vertex attribute that advances once an
  /// instance and not an array in a storage block: llvmpipe reads a block lane by lane, which took half of
  /// its time.
  using ItemPlacement = std::array<glm::vec3, 4>;
  /// Commands of one draw group, and where in it the texture changes.
  struct GroupCommands {
    std::vector<DrawCommand> commands;
    std::size_t first_byte = 0;                                       ///< in the command buffer
    std::vector<std::pair<std::size_t, std::uint32_t>> texture_runs;  ///< first command, texture
  };
  /// A draw group's number: GL state changes between groups only.
  static constexpr std::size_t k_group_count = 8;
  static constexpr std::uint8_t k_double_sided_bit = 1;
  static constexpr std::uint8_t k_mirrored_bit = 2;
  static constexpr std::uint8_t k_mask_bit = 4;

  void upload_vertices(const Scene& scene, bool with_shading);
  void upload_items(const Scene& scene);
  void upload_materials(const Scene& scene);
  void upload_textures(const Scene& scene, bool with_shading);
  void collect(Layer layer, ObjectId id, DrawOrder order, DrawStats& stats);
  void add_command(std::uint32_t item, bool mirrored);
  void upload_commands();
  void submit(std::size_t group_index, const PassPrograms& programs);

  glm::dvec3 world_origin_m_{0.0};
  std::vector<DrawItem> items_;
  std::vector<std::uint32_t> first_item_;  ///< of each object, and one past the last
  std::vector<std::uint8_t> mirrored_;     ///< per object: its placement turns the winding
  std::array<GroupCommands, k_group_count> groups_;
  std::vector<DrawCommand> all_commands_;
  std::vector<ItemPlacement> copies_;

  VertexArray vertex_array_;
  Buffer positions_, normals_, uvs_, indices_, item_attributes_, placements_, materials_, commands_;
  std::vector<TextureName> textures_;  ///< by scene texture; an empty handle where it was not uploaded
  TextureName white_;
};

/// GLSL for the vertex stage, from its #version line on. Declares
///   inputs        0 in_position vec3, 1 in_normal vec3, 2 in_uv vec2, 3 in_object uint, 4 in_material uint,
///                 5-8 the placement, a column each, vec3
///   location 0    uniform mat4 u_clip_from_scene, reversed depth: see depth_clip_from_scene
///   functions     mat4 scene_from_object(); vec4 scene_position(); vec4 clip_position();  // use these, so
///   that
///                 depth agrees to the bit
/// and gl_Position as invariant.
extern const char* const k_transform_glsl;

/// GLSL for the fragment stage, from its #version line on. Declares
///   storage 1     materials[], struct { vec4 base_color; vec4 alpha_cutoff; } (cutoff in .x)
///   unit 0        uniform sampler2D u_texture
///   function      bool alpha_passes(vec2 uv, uint material);  // the mask test, the same in every pass:
///   level 0
extern const char* const k_material_glsl;

/// clip_from_scene with depth reversed to [1 near .. 0 far], for glClipControl(GL_LOWER_LEFT,
/// GL_ZERO_TO_ONE), GL_GREATER and a depth clear of 0. A float depth buffer then keeps about the same
/// relative precision at every distance (Reed, "Depth Precision Visualized", 2015). Computed in double,
/// rounded once.
[[nodiscard]] glm::mat4 depth_clip_from_scene(const Eye& eye, const glm::dvec3& world_origin_m);

/// Sets the depth convention above on the current context: clip control, clear depth, depth test and writes
/// on.
void apply_depth_convention();

}  // namespace sightline::gl
