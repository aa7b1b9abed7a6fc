#include "main_view/client/scene_description.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "common/error.hpp"
#include "protocol/message_checks.hpp"
#include "protocol/scene_chunks.hpp"

namespace sightline {
namespace {

/// FlatBuffers counts bytes in 31 bits; some are the buffer's own.
constexpr std::size_t k_most_bytes = (std::size_t{1} << 31) - (std::size_t{1} << 20);
constexpr std::uint32_t k_max_texture_side = 16384;
constexpr std::size_t k_most_textures = 65'000;  // as many as a reader takes

bool is_fraction(float value) {
  return value >= 0.0f && value <= 1.0f;  // false for NaN
}

bool is_finite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool is_placement(const glm::dmat4x3& matrix) {
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row) {
      if (!(std::abs(matrix[column][row]) <= k_max_matrix_entry)) return false;
    }
  }
  return true;
}

void require_parts(std::span<const MeshPart> parts, std::size_t index_count, std::size_t material_count) {
  for (const MeshPart& part : parts) {
    if (part.index_count % 3 != 0) {
      throw InputError("mesh part of " + std::to_string(part.index_count) +
                       " indices: give three a triangle");
    }
    if (std::uint64_t{part.first_index} + part.index_count > index_count) {
      throw InputError("mesh part ends at index " +
                       std::to_string(std::uint64_t{part.first_index} + part.index_count) + " of " +
                       std::to_string(index_count) + ": give a run of the mesh's own");
    }
    if (static_cast<std::size_t>(part.material) >= material_count) {
      throw InputError("mesh part names material " +
                       std::to_string(static_cast<std::uint32_t>(part.material)) +
                       ", which was not added: add materials first");
    }
  }
}

void require_indices(std::span<const std::uint32_t> indices, std::size_t vertex_count) {
  for (const std::uint32_t index : indices) {
    if (index < vertex_count) continue;
    throw InputError("mesh index " + std::to_string(index) + " of " + std::to_string(vertex_count) +
                     " vertices: give indices into the mesh's own positions");
  }
}

/// Box of the vertices that the parts' triangles use.
Aabb bounds_of(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
               std::span<const MeshPart> parts) {
  Aabb bounds;
  for (const MeshPart& part : parts) {
    for (const std::uint32_t index : indices.subspan(part.first_index, part.index_count))
      bounds.add(positions[index]);
  }
  return bounds;
}

}  // namespace

SceneDescription::SceneDescription() {
  scene_.materials.emplace_back();
}

void SceneDescription::require_room(std::size_t more_bytes) {
  if (more_bytes <= k_most_bytes - byte_count_) return;
  throw InputError("scene is larger than " + std::to_string(k_most_bytes) +
                   " bytes: leave out small objects or share meshes");
}

MaterialId SceneDescription::add_material(const MaterialDescription& material) {
  if (!is_fraction(material.base_alpha) || !is_fraction(material.alpha_cutoff))
    throw InputError("material's base_alpha or alpha_cutoff is not within 0 to 1");
  if (material.alpha_mode > SceneData::AlphaMode::blend)
    throw InputError("material's alpha_mode is unknown: give opaque, mask or blend");
  const auto texture = static_cast<std::uint32_t>(material.alpha_texture);
  if (material.alpha_texture != k_no_alpha_texture && texture >= scene_.alpha_textures.size()) {
    throw InputError("material names alpha texture " + std::to_string(texture) +
                     ", which was not added: add textures first");
  }
  require_room(sizeof(SceneData::Material));
  scene_.materials.push_back(
      {material.base_alpha, material.alpha_cutoff, texture, material.alpha_mode, material.double_sided});
  byte_count_ += sizeof(SceneData::Material);
  return MaterialId{static_cast<std::uint32_t>(scene_.materials.size() - 1)};
}

AlphaTextureId SceneDescription::add_alpha_texture(const AlphaTextureDescription& texture) {
  const std::size_t texels = std::size_t{texture.width} * texture.height;
  if (texels == 0 || texture.width > k_max_texture_side || texture.height > k_max_texture_side) {
    throw InputError("alpha texture of " + std::to_string(texture.width) + "x" +
                     std::to_string(texture.height) + ": give 1 to " + std::to_string(k_max_texture_side) +
                     " texels a side");
  }
  if (texture.alpha.size() != texels) {
    throw InputError("alpha texture has " + std::to_string(texture.alpha.size()) + " bytes, must be " +
                     std::to_string(texels) + ", one a texel");
  }
  if (scene_.alpha_textures.size() >= k_most_textures)
    throw InputError("more than " + std::to_string(k_most_textures) + " alpha textures: share them");
  require_room(texels);
  scene_.alpha_textures.push_back({texture.width,
                                   texture.height,
                                   texture.repeat_u,
                                   texture.repeat_v,
                                   {texture.alpha.begin(), texture.alpha.end()}});
  byte_count_ += texels;
  return AlphaTextureId{static_cast<std::uint32_t>(scene_.alpha_textures.size() - 1)};
}

MeshId SceneDescription::add_mesh(std::span<const glm::vec3> positions,
                                  std::span<const std::uint32_t> indices, MaterialId material,
                                  std::span<const glm::vec2> uvs) {
  require_room(indices.size_bytes());
  const MeshPart all{0, static_cast<std::uint32_t>(indices.size()), material};
  return add_mesh(positions, indices, {&all, 1}, uvs);
}

MeshId SceneDescription::add_mesh(std::span<const glm::vec3> positions,
                                  std::span<const std::uint32_t> indices, std::span<const MeshPart> parts,
                                  std::span<const glm::vec2> uvs) {
  if (!uvs.empty() && uvs.size() != positions.size()) {
    throw InputError("mesh has " + std::to_string(uvs.size()) + " texture coordinates for " +
                     std::to_string(positions.size()) + " vertices: give none or one a vertex");
  }
  // Texture coordinates are of all vertices or of none.
  const bool first_uvs = !uvs.empty() && scene_.uvs.empty();
  const std::size_t vertices_before = scene_.positions.size();
  const bool with_uvs = !uvs.empty() || !scene_.uvs.empty();
  const std::size_t uv_count =
      (with_uvs ? positions.size() : 0) + (first_uvs ? vertices_before : std::size_t{0});
  for (const std::size_t bytes : {positions.size_bytes(), indices.size_bytes(), parts.size_bytes()})
    require_room(bytes);  // one by one: their sum cannot overflow then
  const std::size_t bytes = positions.size_bytes() + indices.size_bytes() +
                            parts.size() * sizeof(SceneData::Primitive) + uv_count * sizeof(glm::vec2) +
                            sizeof(SceneData::Mesh);
  require_room(bytes);
  require_indices(indices, positions.size());
  require_parts(parts, indices.size(), scene_.materials.size());
  if (!std::all_of(positions.begin(), positions.end(), is_finite))
    throw InputError("mesh has a vertex that is not finite");
  for (const glm::vec2& uv : uvs) {
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y))
      throw InputError("mesh has a texture coordinate that is not finite");
  }
  const Aabb bounds = bounds_of(positions, indices, parts);

  const auto first_vertex = static_cast<std::uint32_t>(vertices_before);
  const auto first_index = static_cast<std::uint32_t>(scene_.indices.size());
  const auto first_primitive = static_cast<std::uint32_t>(scene_.primitives.size());
  scene_.positions.insert(scene_.positions.end(), positions.begin(), positions.end());
  if (with_uvs) {
    scene_.uvs.resize(vertices_before);
    scene_.uvs.insert(scene_.uvs.end(), uvs.begin(), uvs.end());
    scene_.uvs.resize(scene_.positions.size());
  }
  for (const std::uint32_t index : indices) scene_.indices.push_back(first_vertex + index);
  std::uint64_t triangles = 0;
  for (const MeshPart& part : parts) {
    if (part.index_count == 0) continue;
    scene_.primitives.push_back(
        {first_index + part.first_index, part.index_count, static_cast<std::uint32_t>(part.material)});
    triangles += part.index_count / 3;
  }
  const auto primitives = static_cast<std::uint32_t>(scene_.primitives.size()) - first_primitive;
  scene_.meshes.push_back({first_primitive, primitives});
  mesh_bounds_.push_back(bounds);
  mesh_triangles_.push_back(triangles);
  byte_count_ += bytes;
  return MeshId{static_cast<std::uint32_t>(scene_.meshes.size() - 1)};
}

ObjectId SceneDescription::add_object(MeshId mesh, const glm::dmat4x3& world_from_object, std::uint32_t flags,
                                      std::uint32_t group) {
  const auto mesh_index = static_cast<std::uint32_t>(mesh);
  if (mesh_index >= scene_.meshes.size()) {
    throw InputError("object names mesh " + std::to_string(mesh_index) +
                     ", which was not added: add meshes first");
  }
  if (!is_placement(world_from_object)) {
    throw InputError("world_from_object of object " + std::to_string(scene_.objects.size()) +
                     " is not finite or too large");
  }
  if ((flags & ~k_all_object_flags) != 0)
    throw InputError("object flags " + std::to_string(flags) + " are unknown: give bits of ObjectFlag");
  if (scene_.object_count() >= k_max_object_count) throw InputError("more objects than there are ids");
  require_room(sizeof(SceneData::Object));
  scene_.objects.push_back({world_from_object, mesh_index, flags, group});
  triangle_count_ += mesh_triangles_[mesh_index];
  byte_count_ += sizeof(SceneData::Object);
  return ObjectId{static_cast<std::uint32_t>(scene_.objects.size() - 1)};
}

void SceneDescription::set_spare_objects(std::uint32_t count) {
  if (scene_.objects.size() + std::uint64_t{count} > k_max_object_count)
    throw InputError("spare_objects " + std::to_string(count) + ": more objects than there are ids");
  scene_.spare_objects = count;
}

std::shared_ptr<const PackedScene> SceneDescription::pack() {
  if (triangle_count_ == 0) throw InputError("scene has no object with a triangle: add meshes and objects");
  auto packed = std::make_shared<PackedScene>();
  packed->objects.spare_objects = scene_.spare_objects;
  packed->objects.objects.reserve(scene_.objects.size());
  for (const SceneData::Object& object : scene_.objects) {
    packed->objects.objects.push_back(
        {mesh_bounds_[object.mesh], object.world_from_object, object.flags, object.group});
  }
  packed->bytes = encode_scene_data(scene_);
  packed->offer = offer_of(packed->bytes, static_cast<std::uint32_t>(scene_.object_count()), triangle_count_);
  packed->objects.digest = packed->offer.scene_digest;
  *this = SceneDescription();
  return packed;
}

}  // namespace sightline
