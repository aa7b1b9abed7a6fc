#include "main_view/client/c_api/scene_handle.hpp"

#include <cstring>
#include <numeric>
#include <span>
#include <string>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "main_view/client/c_api/failure.hpp"
#include "main_view/client/c_api/placement.hpp"

namespace sightline::c_api {
namespace {

constinit SceneTable the_scene_table;

constexpr std::uint32_t k_known_flags = SL_OBJECT_BLENDED | SL_OBJECT_ALPHA_TESTED |
                                        SL_OBJECT_ALWAYS_VISIBLE | SL_OBJECT_OCCLUDER_ONLY |
                                        SL_OBJECT_OCCLUDEE_ONLY | SL_OBJECT_NO_SHADOW;

constexpr std::uint32_t bit_of(ObjectFlag flag) {
  return static_cast<std::uint32_t>(flag);
}

/// Vectors that lie `stride` bytes apart (0: tightly), side by side.
template <typename Vector>
std::vector<Vector> gathered(const float* first, std::size_t stride, std::size_t count, const char* field) {
  if (stride == 0) stride = sizeof(Vector);
  if (stride < sizeof(Vector)) {
    fail(SL_ERROR_ARGUMENT,
         std::string("sl_mesh.") + field + ": 0 or at least " + std::to_string(sizeof(Vector)) + " bytes");
  }
  std::vector<Vector> vectors(count);
  const auto* bytes = reinterpret_cast<const unsigned char*>(first);
  for (std::size_t i = 0; i < count; ++i) std::memcpy(&vectors[i], bytes + i * stride, sizeof(Vector));
  return vectors;
}

[[noreturn]] void refuse_more_objects() {
  fail(SL_ERROR_FULL, "a scene has at most " + std::to_string(SL_MAX_OBJECTS) + " objects, spares included");
}

std::vector<std::uint32_t> indices_of(const sl_mesh& mesh) {
  if (mesh.indices != nullptr) {
    constexpr std::size_t k_most = 0xffffffffu;
    if (mesh.index_count > k_most) fail(SL_ERROR_RANGE, "sl_mesh.index_count: too many");
    return {mesh.indices, mesh.indices + mesh.index_count};
  }
  std::vector<std::uint32_t> indices(mesh.vertex_count);
  std::iota(indices.begin(), indices.end(), 0u);
  return indices;
}

MaterialDescription description_of(const sl_material& material) {
  if (material.alpha > SL_ALPHA_BLENDED) fail(SL_ERROR_ARGUMENT, "sl_material.alpha: none of SL_ALPHA_...");
  if (material.single_sided > 1) fail(SL_ERROR_ARGUMENT, "sl_material.single_sided: 0 or 1");
  MaterialDescription description;
  description.alpha_mode = material.alpha == SL_ALPHA_BLENDED  ? SceneData::AlphaMode::blend
                           : material.alpha == SL_ALPHA_TESTED ? SceneData::AlphaMode::mask
                                                               : SceneData::AlphaMode::opaque;
  if (material.base_alpha != 0.0f) description.base_alpha = material.base_alpha;
  if (material.alpha_cutoff != 0.0f) description.alpha_cutoff = material.alpha_cutoff;
  description.double_sided = material.single_sided == 0;
  return description;
}

}  // namespace

SceneTable& scene_table() noexcept {
  return the_scene_table;
}

std::uint32_t object_flags_of(std::uint32_t flags) {
  if ((flags & ~k_known_flags) != 0) fail(SL_ERROR_ARGUMENT, "flags: others than SL_OBJECT_...");
  const auto either = [flags](std::uint32_t asked, ObjectFlag flag) {
    return (flags & asked) != 0 ? bit_of(flag) : 0u;
  };
  constexpr std::uint32_t k_no_occluder =
      SL_OBJECT_BLENDED | SL_OBJECT_ALPHA_TESTED | SL_OBJECT_OCCLUDEE_ONLY;
  if ((flags & k_no_occluder) != 0 && (flags & SL_OBJECT_OCCLUDER_ONLY) != 0) {
    fail(SL_ERROR_ARGUMENT, "flags: an occluder only that hides nothing");
  }
  return either(k_no_occluder, ObjectFlag::hides_nothing) |
         either(SL_OBJECT_OCCLUDER_ONLY, ObjectFlag::occluder_only) |
         either(SL_OBJECT_NO_SHADOW, ObjectFlag::casts_no_shadow) |
         either(SL_OBJECT_ALWAYS_VISIBLE, ObjectFlag::always_visible);
}

SceneHandle::SceneHandle(bool row_major) : row_major_(row_major) {
  MaterialDescription both_sides;  // material 0 here: who culls no back faces must lose nothing
  both_sides.double_sided = true;
  materials_.push_back(description_.add_material(both_sides));
  has_holes_.push_back(false);
}

void SceneHandle::require_unfinished() const {
  if (packed_) fail(SL_ERROR_ORDER, "the description is finished: nothing can be added to it");
}

std::uint32_t SceneHandle::add_material(const sl_material& material) {
  require_unfinished();
  MaterialDescription description = description_of(material);
  const bool tested = description.alpha_mode == SceneData::AlphaMode::mask;
  const bool textured = tested && material.texture_width != 0;
  if (textured) {
    if (material.alpha_texture == nullptr) fail(SL_ERROR_ARGUMENT, "sl_material.alpha_texture: null");
    AlphaTextureDescription texture;
    texture.width = material.texture_width;
    texture.height = material.texture_height;
    texture.alpha = {material.alpha_texture,
                     std::size_t{material.texture_width} * std::size_t{material.texture_height}};
    description.alpha_texture = description_.add_alpha_texture(texture);
  }
  materials_.push_back(description_.add_material(description));
  has_holes_.push_back(tested && !textured);
  return static_cast<std::uint32_t>(materials_.size() - 1);
}

std::uint32_t SceneHandle::add_mesh(const sl_mesh& mesh) {
  require_unfinished();
  if (mesh.positions == nullptr || mesh.vertex_count == 0) {
    fail(SL_ERROR_ARGUMENT, "sl_mesh: no positions");
  }
  const auto positions =
      gathered<glm::vec3>(mesh.positions, mesh.position_stride, mesh.vertex_count, "position_stride");
  std::vector<glm::vec2> uvs;
  if (mesh.texcoords != nullptr) {
    uvs = gathered<glm::vec2>(mesh.texcoords, mesh.texcoord_stride, mesh.vertex_count, "texcoord_stride");
  }
  const std::vector<std::uint32_t> indices = indices_of(mesh);

  const sl_part whole{0, static_cast<std::uint32_t>(indices.size()), mesh.material};
  if (mesh.parts != nullptr && (mesh.part_count == 0 || mesh.part_count > indices.size())) {
    fail(SL_ERROR_RANGE, "sl_mesh.part_count: none, or more than triangles");
  }
  const auto parts = mesh.parts != nullptr ? std::span(mesh.parts, mesh.part_count) : std::span(&whole, 1);
  std::vector<MeshPart> described;
  described.reserve(parts.size());
  bool holes = false;
  for (const sl_part& part : parts) {
    if (part.material >= materials_.size()) {
      fail(SL_ERROR_RANGE,
           "sl_mesh: material " + std::to_string(part.material) + " of " + std::to_string(materials_.size()));
    }
    holes = holes || has_holes_[part.material];
    described.push_back({part.first_index, part.index_count, materials_[part.material]});
  }
  meshes_.push_back(description_.add_mesh(positions, indices, described, uvs));
  mesh_has_holes_.push_back(holes);
  return static_cast<std::uint32_t>(meshes_.size() - 1);
}

std::uint32_t SceneHandle::add_object(const sl_object& object) {
  require_unfinished();
  if (object.mesh >= meshes_.size()) {
    fail(SL_ERROR_RANGE,
         "sl_object.mesh: " + std::to_string(object.mesh) + " of " + std::to_string(meshes_.size()));
  }
  if (std::uint64_t{description_.object_count()} + spares_ >= SL_MAX_OBJECTS) refuse_more_objects();
  std::uint32_t flags = object_flags_of(object.flags);
  if (mesh_has_holes_[object.mesh] && !has(flags, ObjectFlag::occluder_only)) {
    flags |= bit_of(ObjectFlag::hides_nothing);
  }
  const ObjectId id = description_.add_object(
      meshes_[object.mesh], placement_or_identity(object.world_from_object, row_major_), flags, object.group);
  return static_cast<std::uint32_t>(id);
}

void SceneHandle::set_spares(std::uint32_t count) {
  require_unfinished();
  if (std::uint64_t{description_.object_count()} + count > SL_MAX_OBJECTS) refuse_more_objects();
  description_.set_spare_objects(count);
  spares_ = count;
}

std::shared_ptr<const PackedScene> SceneHandle::packed() {
  if (!packed_) packed_ = description_.pack();
  return packed_;
}

}  // namespace sightline::c_api
