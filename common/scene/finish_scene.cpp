#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "common/scene/hash_scene.hpp"
#include "common/scene/refuse_scene.hpp"
#include "common/scene/scene.hpp"

namespace sightline {
namespace {

template <class Vector>
bool all_finite(const std::vector<Vector>& values) {
  // x * 0 is zero for every finite x and NaN for the rest: one sum, which the compiler vectorises.
  const float* const first = values.empty() ? nullptr : &values.front()[0];
  const std::size_t count = values.size() * Vector::length();
  float sum = 0.0f;
  float lanes[8] = {};
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8) {
    for (std::size_t lane = 0; lane < 8; ++lane) lanes[lane] += first[i + lane] * 0.0f;
  }
  for (; i < count; ++i) sum += first[i] * 0.0f;
  for (const float lane : lanes) sum += lane;
  return sum == 0.0f;
}

bool is_affine_and_finite(const glm::dmat4& m) {
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      if (!std::isfinite(m[column][row])) return false;
    }
  }
  return m[0][3] == 0.0 && m[1][3] == 0.0 && m[2][3] == 0.0 && m[3][3] == 1.0;
}

std::string numbered(const char* what, std::size_t index) {
  return std::string(what) + " " + std::to_string(index);
}

void check_vertices(const Scene& scene, const std::string& name) {
  const std::size_t count = scene.positions.size();
  if (count > std::numeric_limits<std::uint32_t>::max())
    refuse_scene(name, "has more than 2^32 vertices; split it");
  if (!scene.normals.empty() && scene.normals.size() != count)
    refuse_scene(name, "has not one normal a vertex");
  if (!scene.uvs.empty() && scene.uvs.size() != count) {
    refuse_scene(name, "has not one texture coordinate a vertex");
  }
  if (!all_finite(scene.positions))
    refuse_scene(name, "a vertex position is not a finite number; repair the file");
  if (!all_finite(scene.normals)) refuse_scene(name, "a normal is not a finite number; repair the file");
  if (!all_finite(scene.uvs))
    refuse_scene(name, "a texture coordinate is not a finite number; repair the file");
}

void check_materials(const Scene& scene, const std::string& name) {
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& material = scene.materials[i];
    const glm::vec4& c = material.base_color;
    if (!std::isfinite(c.x + c.y + c.z + c.w) || !std::isfinite(material.alpha_cutoff)) {
      refuse_scene(name, numbered("material", i) + ": a factor is not a finite number");
    }
    if (material.texture != k_no_texture && material.texture >= scene.textures.size()) {
      refuse_scene(name, numbered("material", i) + ": names a texture that does not exist");
    }
  }
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    const Texture& texture = scene.textures[i];
    const std::size_t pixels = std::size_t{texture.width} * texture.height;
    if (pixels == 0 || texture.rgba.size() / 4 != pixels || texture.rgba.size() % 4 != 0) {
      refuse_scene(name, numbered("texture", i) + ": its size does not match its pixels");
    }
  }
}

void check_meshes(const Scene& scene, const std::string& name) {
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    const Mesh& mesh = scene.meshes[i];
    if (std::uint64_t{mesh.first_primitive} + mesh.primitive_count > scene.primitives.size()) {
      refuse_scene(name, numbered("mesh", i) + ": names primitives that do not exist");
    }
  }
  const std::size_t vertex_count = scene.positions.size();
  for (std::size_t i = 0; i < scene.primitives.size(); ++i) {
    const Primitive& primitive = scene.primitives[i];
    const std::uint64_t end = std::uint64_t{primitive.first_index} + primitive.index_count;
    if (end > scene.indices.size() || primitive.index_count % 3 != 0 ||
        primitive.material >= scene.materials.size()) {
      refuse_scene(name, numbered("primitive", i) + ": names indices or a material that do not exist");
    }
    std::uint32_t largest = 0;
    for (std::uint64_t k = primitive.first_index; k < end; ++k) largest = std::max(largest, scene.indices[k]);
    if (primitive.index_count > 0 && largest >= vertex_count) {
      refuse_scene(name, numbered("primitive", i) + ": index " + std::to_string(largest) +
                             " is out of range (" + std::to_string(vertex_count) + " vertices)");
    }
  }
}

/// A renderer keeps a record of each primitive of each object, and instancing multiplies the two from next to
/// no bytes. Without instancing a primitive that draws anything has three indices, 12 bytes, of its own, so
/// the second term lets every such scene pass; the first is what instances may add: ten million objects of a
/// primitive or two, and about 1 GB of records at 64 bytes each.
void check_draws(const Scene& scene, const std::string& name) {
  constexpr std::uint64_t k_unquestioned_draws = std::uint64_t{1} << 24;
  constexpr std::uint64_t k_least_bytes_a_primitive = 3 * sizeof(std::uint32_t);
  std::uint64_t draws = 0;  // 2^32 objects of 2^32 primitives still fit
  for (const Object& object : scene.objects) draws += scene.meshes[object.mesh].primitive_count;
  if (draws > k_unquestioned_draws + scene.geometry_bytes() / k_least_bytes_a_primitive) {
    refuse_scene(name, "its instances draw " + std::to_string(draws) +
                           " primitives, more than its geometry justifies; join primitives or split it");
  }
}

void check_objects(const Scene& scene, const std::string& name) {
  if (scene.objects.size() > k_max_object_count) refuse_scene(name, "has more objects than ids; split it");
  if (!scene.object_names.empty() && scene.object_names.size() != scene.objects.size()) {
    refuse_scene(name, "has not one name an object");
  }
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const Object& object = scene.objects[i];
    if (object.mesh >= scene.meshes.size()) {
      refuse_scene(name, numbered("object", i) + ": names a mesh that does not exist");
    }
    if (!is_affine_and_finite(object.scene_from_object)) {
      refuse_scene(name, numbered("object", i) + ": its transform is not affine and finite");
    }
  }
  check_draws(scene, name);  // before any loop over the primitives of every object
  bool any_triangle = false;
  for (std::uint32_t i = 0; i < scene.object_count() && !any_triangle; ++i) {
    any_triangle = scene.triangle_count(ObjectId{i}) > 0;
  }
  if (!any_triangle) refuse_scene(name, "no object has a triangle; there is nothing to draw");
}

void bound_meshes(Scene& scene) {
  for (Mesh& mesh : scene.meshes) {
    mesh.bounds = {};
    for (std::uint32_t i = 0; i < mesh.primitive_count; ++i) {
      const Primitive& primitive = scene.primitives[mesh.first_primitive + i];
      const std::uint32_t* const first = scene.indices.data() + primitive.first_index;
      for (std::uint32_t k = 0; k < primitive.index_count; ++k) mesh.bounds.add(scene.positions[first[k]]);
    }
  }
}

/// Moves the scene frame when the scene lies far from the world's origin, where floats have no millimetres
/// left.
void move_origin_near(Scene& scene) {
  constexpr double k_far_m = 1000.0;
  constexpr double k_absurd_m = 1e12;
  if (scene.world_origin_m != glm::dvec3(0.0)) return;
  glm::dvec3 low(std::numeric_limits<double>::infinity());
  glm::dvec3 high = -low;
  for (const Object& object : scene.objects) {
    const Aabb& box = scene.meshes[object.mesh].bounds;
    if (box.empty()) continue;
    const glm::dvec3 center = object.scene_from_object * glm::dvec4(glm::dvec3(box.center()), 1.0);
    const glm::dmat3 turn(object.scene_from_object);
    const glm::dvec3 half(0.5f * box.extent());
    const glm::dvec3 reach =
        glm::abs(turn[0]) * half.x + glm::abs(turn[1]) * half.y + glm::abs(turn[2]) * half.z;
    low = glm::min(low, center - reach);
    high = glm::max(high, center + reach);
  }
  const glm::dvec3 center = glm::round(0.5 * (low + high));
  const double furthest = std::max({std::abs(center.x), std::abs(center.y), std::abs(center.z)});
  if (!(furthest > k_far_m) || !(furthest < k_absurd_m)) return;  // the bounds refuse what is absurd
  scene.world_origin_m = center;
  for (Object& object : scene.objects) {
    object.scene_from_object[3] -= glm::dvec4(center, 0.0);
  }
}

bool finite(const Aabb& box) {
  return std::isfinite(box.min.x + box.min.y + box.min.z) && std::isfinite(box.max.x + box.max.y + box.max.z);
}

void bound_objects(Scene& scene, const std::string& name) {
  scene.bounds = {};
  scene.object_bounds.resize(scene.objects.size());
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const Object& object = scene.objects[i];
    const Aabb box = transformed(scene.meshes[object.mesh].bounds, object.scene_from_object);
    if (!box.empty() && !finite(box)) {
      refuse_scene(name,
                   numbered("object", i) + ": lies beyond the range of a float; scale the scene to metres");
    }
    scene.object_bounds[i] = box;
    scene.bounds.add(box);
  }
}

}  // namespace

void finish_scene(Scene& scene, const std::string& name) {
  if (scene.materials.empty()) scene.materials.emplace_back();
  check_vertices(scene, name);
  check_materials(scene, name);
  check_meshes(scene, name);
  check_objects(scene, name);
  bound_meshes(scene);
  move_origin_near(scene);
  bound_objects(scene, name);
  scene.digest = hash_scene(scene);
}

}  // namespace sightline
