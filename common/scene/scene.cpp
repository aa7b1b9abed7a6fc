#include "common/scene/scene.hpp"

namespace sightline {
namespace {

std::uint64_t triangles_of(const Scene& scene, const Mesh& mesh) noexcept {
  std::uint64_t count = 0;
  for (std::uint32_t i = 0; i < mesh.primitive_count; ++i) {
    count += scene.primitives[mesh.first_primitive + i].index_count / 3;
  }
  return count;
}

template <class T>
std::size_t bytes_of(const std::vector<T>& values) noexcept {
  return values.size() * sizeof(T);
}

}  // namespace

std::uint64_t Scene::triangle_count(ObjectId id) const noexcept {
  return triangles_of(*this, meshes[objects[index_of(id)].mesh]);
}

std::uint64_t Scene::triangle_count() const noexcept {
  std::uint64_t count = 0;
  for (const Object& object : objects) count += triangles_of(*this, meshes[object.mesh]);
  return count;
}

std::size_t Scene::geometry_bytes() const noexcept {
  return bytes_of(positions) + bytes_of(normals) + bytes_of(uvs) + bytes_of(indices);
}

}  // namespace sightline
