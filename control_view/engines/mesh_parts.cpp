#include "control_view/engines/mesh_parts.hpp"

#include <algorithm>

#include "common/widest_axis.hpp"

namespace sightline {
namespace {

/// Appends a box a triangle.
void append_triangles(const Scene& scene, const Primitive& primitive, std::vector<Aabb>& boxes) {
  for (std::uint32_t i = 0; i + 2 < primitive.index_count; i += 3) {
    Aabb& box = boxes.emplace_back();
    for (std::uint32_t corner = 0; corner < 3; ++corner) {
      box.add(scene.positions[scene.indices[primitive.first_index + i + corner]]);
    }
  }
}

int widest_axis_of_centers(std::span<const Aabb> boxes) {
  Aabb centers;
  for (const Aabb& box : boxes) centers.add(box.center());
  return widest_axis(centers.extent());
}

}  // namespace

MeshParts::MeshParts(const Scene& scene) {
  std::vector<Aabb> triangles;
  first_.reserve(2 * scene.meshes.size() + 1);
  for (const Mesh& mesh : scene.meshes) {
    for (const bool blended : {false, true}) {
      first_.push_back(boxes_.size());
      triangles.clear();
      for (std::uint32_t i = 0; i < mesh.primitive_count; ++i) {
        const Primitive& primitive = scene.primitives[mesh.first_primitive + i];
        const bool is_blended = scene.materials[primitive.material].alpha_mode == AlphaMode::blend;
        if (is_blended == blended) append_triangles(scene, primitive, triangles);
      }
      add_parts(triangles);
    }
  }
  first_.push_back(boxes_.size());
}

/// Halves by the middle centre along the widest axis until the parts are small: at most 32 levels deep.
void MeshParts::add_parts(std::span<Aabb> triangles) {
  if (triangles.empty()) return;
  if (triangles.size() <= k_part_triangles) {
    Aabb part;
    for (const Aabb& triangle : triangles) part.add(triangle);
    boxes_.push_back(part);
    return;
  }
  const int axis = widest_axis_of_centers(triangles);
  const auto middle = triangles.begin() + static_cast<std::ptrdiff_t>(triangles.size() / 2);
  std::nth_element(triangles.begin(), middle, triangles.end(), [axis](const Aabb& a, const Aabb& b) {
    return a.min[axis] + a.max[axis] < b.min[axis] + b.max[axis];
  });
  add_parts({triangles.begin(), middle});
  add_parts({middle, triangles.end()});
}

}  // namespace sightline
