#include "tests/control_view/triangle_soup.hpp"

#include <string>

namespace sightline::test {

TriangleSoup::TriangleSoup() {
  Material material;
  scene_.materials.push_back(material);
  material.double_sided = true;
  scene_.materials.push_back(material);
  material.alpha_mode = AlphaMode::blend;
  scene_.materials.push_back(material);
}

void TriangleSoup::begin_object(Side side, const glm::dmat4& scene_from_object) {
  Mesh mesh;
  mesh.first_primitive = static_cast<std::uint32_t>(scene_.primitives.size());
  mesh.primitive_count = 1;
  scene_.primitives.push_back({static_cast<std::uint32_t>(scene_.indices.size()), 0, side});
  const auto id = static_cast<std::uint32_t>(scene_.objects.size());
  scene_.objects.push_back({static_cast<std::uint32_t>(scene_.meshes.size()), scene_from_object});
  scene_.object_names.push_back("object " + std::to_string(id));
  scene_.meshes.push_back(mesh);
}

void TriangleSoup::add(const Triangle& triangle) {
  for (const glm::vec3& corner : triangle) {
    scene_.indices.push_back(static_cast<std::uint32_t>(scene_.positions.size()));
    scene_.positions.push_back(corner);
  }
  scene_.primitives.back().index_count += 3;
}

void TriangleSoup::add_alone(const Triangle& triangle, Side side, const glm::dmat4& scene_from_object) {
  begin_object(side, scene_from_object);
  add(triangle);
}

Scene TriangleSoup::finish() {
  finish_scene(scene_, "triangle soup");
  return scene_;
}

}  // namespace sightline::test
