#include "tests/common/test_scenes.hpp"

#include <cstdlib>
#include <stdexcept>
#include <system_error>

#include <glm/ext/matrix_transform.hpp>
#include <glm/ext/scalar_constants.hpp>
#include <glm/geometric.hpp>

namespace sightline::testing {

namespace fs = std::filesystem;

std::optional<fs::path> shared_folder() {
  const fs::path folder = fs::path(SIGHTLINE_SOURCE_DIR) / ".." / "shared";
  std::error_code error;
  if (!fs::is_directory(folder, error)) return {};
  return fs::canonical(folder);
}

fs::path scenes_folder() {
  return fs::path(SIGHTLINE_SOURCE_DIR) / "scenes";
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (fs::temp_directory_path() / "sightline-test-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("mkdtemp failed: " + name);
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code error;
  fs::remove_all(path_, error);
}

Material opaque(const glm::vec3& color) {
  Material material;
  material.base_color = glm::vec4(color, 1.0f);
  return material;
}

Material glass(float alpha) {
  Material material;
  material.base_color = {0.6f, 0.8f, 0.9f, alpha};
  material.alpha_mode = AlphaMode::blend;
  return material;
}

Material double_sided(Material material) {
  material.double_sided = true;
  return material;
}

std::uint32_t SceneBuilder::add_material(const Material& material) {
  scene_.materials.push_back(material);
  return static_cast<std::uint32_t>(scene_.materials.size() - 1);
}

std::uint32_t SceneBuilder::add_checker_mask(std::uint32_t cells, bool both_sides) {
  constexpr std::uint32_t k_cell_pixels = 8;
  Texture texture;
  texture.width = texture.height = cells * k_cell_pixels;
  for (std::uint32_t row = 0; row < texture.height; ++row) {
    for (std::uint32_t column = 0; column < texture.width; ++column) {
      const bool solid = (row / k_cell_pixels + column / k_cell_pixels) % 2 == 0;
      texture.rgba.insert(texture.rgba.end(), {200, 200, 200, static_cast<std::uint8_t>(solid ? 255 : 0)});
    }
  }
  Material material;
  material.alpha_mode = AlphaMode::mask;
  material.double_sided = both_sides;
  material.texture = static_cast<std::uint32_t>(scene_.textures.size());
  scene_.textures.push_back(std::move(texture));
  return add_material(material);
}

ObjectId SceneBuilder::add_box(const glm::dvec3& center, const glm::dvec3& size, std::uint32_t material) {
  return add_object(box_mesh(material), glm::scale(glm::translate(glm::dmat4(1.0), center), size));
}

ObjectId SceneBuilder::add_wall(const glm::dvec3& center, double width, double height, std::uint32_t material,
                                double yaw_rad) {
  const glm::dmat4 turned =
      glm::rotate(glm::translate(glm::dmat4(1.0), center), yaw_rad, glm::dvec3(0, 1, 0));
  return add_object(quad_mesh(material), glm::scale(turned, glm::dvec3(width, height, 1.0)));
}

ObjectId SceneBuilder::add_ground(const glm::dvec3& center, double size_x, double size_z,
                                  std::uint32_t material) {
  // Columns written out: a rotation by pi/2 would leave 6e-17 where a zero belongs.
  glm::dmat4 lying(0.0);
  lying[0] = {size_x, 0.0, 0.0, 0.0};
  lying[1] = {0.0, 0.0, -size_z, 0.0};
  lying[2] = {0.0, 1.0, 0.0, 0.0};
  lying[3] = glm::dvec4(center, 1.0);
  return add_object(quad_mesh(material), lying);
}

std::uint32_t SceneBuilder::box_mesh(std::uint32_t material) {
  const auto known = box_of_material_.find(material);
  if (known != box_of_material_.end()) return known->second;
  const auto first = static_cast<std::uint32_t>(scene_.indices.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-0.5f, 0.5f}) {
      glm::vec3 center(0.0f);
      glm::vec3 right(0.0f);
      glm::vec3 up(0.0f);
      center[axis] = side;
      right[(axis + 1) % 3] = side > 0 ? 1.0f : -1.0f;
      up[(axis + 2) % 3] = 1.0f;
      add_face(center, right, up);
    }
  }
  return box_of_material_[material] = close_mesh(first, material);
}

std::uint32_t SceneBuilder::quad_mesh(std::uint32_t material) {
  const auto known = quad_of_material_.find(material);
  if (known != quad_of_material_.end()) return known->second;
  const auto first = static_cast<std::uint32_t>(scene_.indices.size());
  add_face(glm::vec3(0.0f), {1, 0, 0}, {0, 1, 0});
  return quad_of_material_[material] = close_mesh(first, material);
}

ObjectId SceneBuilder::add_object(std::uint32_t mesh, const glm::dmat4& scene_from_object) {
  const auto id = static_cast<std::uint32_t>(scene_.objects.size());
  scene_.objects.push_back({mesh, scene_from_object});
  scene_.object_names.push_back("object " + std::to_string(id));
  return ObjectId{id};
}

Scene SceneBuilder::finish(const std::string& name) const {
  Scene scene = scene_;
  finish_scene(scene, name);
  return scene;
}

/// Four vertices and two triangles, counter-clockwise seen from right x up.
void SceneBuilder::add_face(const glm::vec3& center, const glm::vec3& right, const glm::vec3& up) {
  const auto base = static_cast<std::uint32_t>(scene_.positions.size());
  for (const float v : {-0.5f, 0.5f}) {
    for (const float u : {-0.5f, 0.5f}) {
      scene_.positions.push_back(center + u * right + v * up);
      scene_.normals.push_back(glm::cross(right, up));
      scene_.uvs.emplace_back(u + 0.5f, 0.5f - v);
    }
  }
  for (const std::uint32_t corner : {0u, 1u, 3u, 0u, 3u, 2u}) scene_.indices.push_back(base + corner);
}

std::uint32_t SceneBuilder::close_mesh(std::uint32_t first_index, std::uint32_t material) {
  const auto primitive = static_cast<std::uint32_t>(scene_.primitives.size());
  const auto end = static_cast<std::uint32_t>(scene_.indices.size());
  scene_.primitives.push_back({first_index, end - first_index, material});
  scene_.meshes.push_back({primitive, 1, {}});
  return static_cast<std::uint32_t>(scene_.meshes.size() - 1);
}

}  // namespace sightline::testing
