#include "common/scene/city_shapes.hpp"

#include "common/scene/shape_builder.hpp"

namespace sightline {
namespace {

std::uint32_t add_material(Scene& scene, const glm::vec3& color) {
  Material material;
  material.base_color = glm::vec4(color, 1.0f);
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

std::uint32_t add_glass(Scene& scene) {
  const std::uint32_t glass = add_material(scene, {0.5f, 0.7f, 0.8f});
  scene.materials[glass].base_color.a = 0.35f;
  scene.materials[glass].alpha_mode = AlphaMode::blend;
  return glass;
}

/// Leaves cut out of a card: opaque in discs, two-sided.
std::uint32_t add_foliage(Scene& scene) {
  constexpr std::uint32_t k_side = 64;
  constexpr std::uint32_t k_leaf = 16;
  Texture texture;
  texture.width = texture.height = k_side;
  for (std::uint32_t y = 0; y < k_side; ++y) {
    for (std::uint32_t x = 0; x < k_side; ++x) {
      const int dx = static_cast<int>(x % k_leaf) - 8;
      const int dy = static_cast<int>(y % k_leaf) - 8;
      const bool leaf = dx * dx + dy * dy < 50;
      texture.rgba.insert(texture.rgba.end(), {60, 130, 50, static_cast<std::uint8_t>(leaf ? 255 : 0)});
    }
  }
  scene.textures.push_back(std::move(texture));
  Material material;
  material.alpha_mode = AlphaMode::mask;
  material.double_sided = true;
  material.texture = static_cast<std::uint32_t>(scene.textures.size() - 1);
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

std::uint32_t building(ShapeBuilder& shape, std::uint32_t wall, std::uint32_t trim, int floors) {
  constexpr float k_half = CityShapes::k_building_side_m / 2;
  constexpr float k_floor_m = 3.2f;
  const float height = k_floor_m * static_cast<float>(floors);
  shape.begin_material(wall);
  shape.add_box({-k_half, 0, -k_half}, {k_half, height, k_half});
  shape.add_box({-3, height, -3}, {3, height + 2.5f, 3});
  shape.begin_material(trim);
  for (int floor = 1; floor <= floors; ++floor) {
    const float y = k_floor_m * static_cast<float>(floor);
    shape.add_box({-k_half - 0.2f, y - 0.3f, -k_half - 0.2f}, {k_half + 0.2f, y, k_half + 0.2f});
  }
  return shape.close_mesh();
}

std::uint32_t car(ShapeBuilder& shape, std::uint32_t paint, std::uint32_t dark, std::uint32_t glass) {
  shape.begin_material(paint);
  shape.add_box({-2.1f, 0.35f, -0.85f}, {2.1f, 0.9f, 0.85f});
  shape.add_box({-1.1f, 1.35f, -0.75f}, {0.9f, 1.45f, 0.75f});
  shape.begin_material(dark);
  for (const float x : {-1.35f, 1.35f}) {
    for (const float z : {-0.75f, 0.75f}) {
      const glm::vec2 tyre[] = {{0, -0.34f}, {0.3f, -0.3f}, {0.34f, 0}, {0.3f, 0.3f}, {0, 0.34f}};
      shape.add_lathe({x, 0.34f, z}, tyre, 8);
    }
  }
  shape.begin_material(glass);
  shape.add_box({-1.1f, 0.9f, -0.75f}, {0.9f, 1.35f, 0.75f});
  return shape.close_mesh();
}

std::uint32_t tree(ShapeBuilder& shape, std::uint32_t bark, std::uint32_t crown, std::uint32_t foliage) {
  const glm::vec2 trunk[] = {{0.2f, 0}, {0.15f, 1.5f}, {0.1f, 3.0f}, {0, 3.5f}};
  const glm::vec2 ball[] = {{0, 2.2f}, {0.9f, 2.5f}, {1.3f, 3.4f}, {1.0f, 4.4f}, {0, 4.9f}};
  shape.begin_material(bark);
  shape.add_lathe(glm::vec3(0), trunk, 8);
  shape.begin_material(crown);
  shape.add_lathe(glm::vec3(0), ball, 12);
  shape.begin_material(foliage);
  shape.add_quad({-1.8f, 2, 0}, {3.6f, 0, 0}, {0, 3.4f, 0});
  shape.add_quad({0, 2, -1.8f}, {0, 0, 3.6f}, {0, 3.4f, 0});
  return shape.close_mesh();
}

std::uint32_t window(ShapeBuilder& shape, std::uint32_t trim, std::uint32_t glass) {
  shape.begin_material(trim);
  for (const float x : {-0.8f, -0.05f, 0.7f}) shape.add_box({x, 0, 0}, {x + 0.1f, 1.6f, 0.15f});
  for (const float y : {0.0f, 0.5f, 1.0f, 1.5f}) shape.add_box({-0.8f, y, 0}, {0.8f, y + 0.1f, 0.12f});
  shape.begin_material(glass);
  shape.add_quad({-0.8f, 0, 0.06f}, {1.6f, 0, 0}, {0, 1.6f, 0});
  return shape.close_mesh();
}

std::uint32_t balcony(ShapeBuilder& shape, std::uint32_t trim) {
  shape.begin_material(trim);
  shape.add_box({-1.5f, 0, 0}, {1.5f, 0.15f, 1.2f});
  shape.add_box({-1.5f, 1.0f, 1.1f}, {1.5f, 1.1f, 1.2f});
  for (int i = 0; i <= 10; ++i) {
    const float x = -1.5f + 0.295f * static_cast<float>(i);
    shape.add_box({x, 0.15f, 1.13f}, {x + 0.05f, 1.0f, 1.18f});
  }
  return shape.close_mesh();
}

std::uint32_t lamp(ShapeBuilder& shape, std::uint32_t metal) {
  const glm::vec2 pole[] = {{0.15f, 0}, {0.08f, 0.6f}, {0.06f, 4.5f}, {0.3f, 4.6f}, {0.25f, 4.9f}, {0, 5.0f}};
  shape.begin_material(metal);
  shape.add_lathe(glm::vec3(0), pole, 12);
  return shape.close_mesh();
}

std::uint32_t fence(ShapeBuilder& shape, std::uint32_t metal) {
  shape.begin_material(metal);
  for (int i = 0; i < 11; ++i) {
    const float x = -2.0f + 0.4f * static_cast<float>(i);
    shape.add_box({x - 0.03f, 0, -0.03f}, {x + 0.03f, 1.1f, 0.03f});
  }
  shape.add_box({-2, 0.9f, -0.02f}, {2, 0.95f, 0.02f});
  return shape.close_mesh();
}

std::uint32_t sign(ShapeBuilder& shape, std::uint32_t metal, std::uint32_t face) {
  const glm::vec2 pole[] = {{0.05f, 0}, {0.05f, 2.6f}, {0, 2.65f}};
  shape.begin_material(metal);
  shape.add_lathe(glm::vec3(0), pole, 10);
  shape.begin_material(face);
  shape.add_wheel({0.06f, 2.3f, 0}, 0.35f, 0.02f, 16);
  return shape.close_mesh();
}

}  // namespace

CityShapes add_city_shapes(Scene& scene, float pitch_m) {
  const std::uint32_t asphalt = add_material(scene, {0.25f, 0.25f, 0.27f});
  const std::uint32_t trim = add_material(scene, {0.85f, 0.83f, 0.8f});
  const std::uint32_t metal = add_material(scene, {0.3f, 0.32f, 0.35f});
  const std::uint32_t bark = add_material(scene, {0.35f, 0.25f, 0.15f});
  const std::uint32_t leaves = add_material(scene, {0.2f, 0.45f, 0.18f});
  const std::uint32_t face = add_material(scene, {0.8f, 0.15f, 0.1f});
  const std::uint32_t glass = add_glass(scene);
  const std::uint32_t foliage = add_foliage(scene);

  CityShapes shapes;
  ShapeBuilder shape(scene);
  const float half = pitch_m / 2;
  shape.begin_material(asphalt);
  shape.add_quad({-half, 0, half}, {pitch_m, 0, 0}, {0, 0, -pitch_m});
  shapes.ground = shape.close_mesh();
  shape.begin_material(trim);
  constexpr float k_across = CityShapes::k_street_width_m / 2;
  shape.add_box({-4, 0, -k_across}, {4, 11, k_across});
  shapes.bridge = shape.close_mesh();

  const glm::vec3 walls[] = {
      {0.7f, 0.45f, 0.35f}, {0.75f, 0.7f, 0.55f}, {0.55f, 0.6f, 0.65f}, {0.6f, 0.35f, 0.3f}};
  for (const glm::vec3& color : walls) {
    const std::uint32_t wall = add_material(scene, color);
    for (const int floors : {5, 8, 11, 14}) shapes.buildings.push_back(building(shape, wall, trim, floors));
  }
  const glm::vec3 paints[] = {{0.7f, 0.1f, 0.1f}, {0.1f, 0.2f, 0.6f}, {0.8f, 0.8f, 0.8f}};
  for (const glm::vec3& color : paints)
    shapes.cars.push_back(car(shape, add_material(scene, color), metal, glass));
  shapes.trees.push_back(tree(shape, bark, leaves, foliage));
  shapes.window = window(shape, trim, glass);
  shapes.balcony = balcony(shape, metal);
  shapes.lamp = lamp(shape, metal);
  shapes.fence = fence(shape, metal);
  shapes.sign = sign(shape, metal, face);
  return shapes;
}

}  // namespace sightline
