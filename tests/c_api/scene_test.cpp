// Descriptions through C: what is refused, and that equal ones are the same scene.

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "tests/c_api/c_program.hpp"

namespace sightline::testing {
namespace {

constexpr float k_nan = std::numeric_limits<float>::quiet_NaN();

TEST(CScene, RefusesStructuresOfTheWrongSize) {
  CScene scene;
  for (const std::uint32_t size :
       {0u, 1u, 4u, static_cast<std::uint32_t>(sizeof(sl_mesh)) - 1, 65537u, 0xffffffffu}) {
    sl_mesh mesh = box_mesh();
    mesh.struct_size = size;
    EXPECT_EQ(sl_scene_add_mesh(scene.get(), &mesh, nullptr), SL_ERROR_STRUCT_SIZE) << size;
  }
  EXPECT_EQ(sl_scene_add_mesh(scene.get(), nullptr, nullptr), SL_ERROR_ARGUMENT);
}

TEST(CScene, TakesAStructureOfALaterHeaderThatAsksForNothingNew) {
  CScene scene;
  struct Later {
    sl_object known;
    std::uint64_t later;
  };
  Later object{box_at(0, 0, 0, 1, 1, 1), 0};
  object.known.struct_size = sizeof object;
  EXPECT_EQ(sl_scene_add_object(scene.get(), &object.known, nullptr), SL_OK);
  object.later = 1;
  EXPECT_EQ(sl_scene_add_object(scene.get(), &object.known, nullptr), SL_ERROR_STRUCT_SIZE);
}

TEST(CScene, RefusesMeshesThatAreNone) {
  CScene scene;
  const auto add = [&](auto change) {
    sl_mesh mesh = box_mesh();
    change(mesh);
    return sl_scene_add_mesh(scene.get(), &mesh, nullptr);
  };
  EXPECT_EQ(add([](sl_mesh& mesh) { mesh.positions = nullptr; }), SL_ERROR_ARGUMENT);
  EXPECT_EQ(add([](sl_mesh& mesh) { mesh.vertex_count = 0; }), SL_ERROR_ARGUMENT);
  EXPECT_LT(add([](sl_mesh& mesh) { mesh.vertex_count = 7; }), 0);  // an index is 7
  EXPECT_LT(add([](sl_mesh& mesh) { mesh.index_count = 35; }), 0);
  EXPECT_EQ(add([](sl_mesh& mesh) { mesh.index_count = std::size_t{1} << 60; }), SL_ERROR_RANGE);
  EXPECT_EQ(add([](sl_mesh& mesh) { mesh.position_stride = 11; }), SL_ERROR_ARGUMENT);
  EXPECT_EQ(add([](sl_mesh& mesh) { mesh.material = 1; }), SL_ERROR_RANGE);
  const sl_part beyond{33, 6, 0}, unknown{0, 36, 9};
  EXPECT_LT(add([&](sl_mesh& mesh) { mesh.parts = &beyond, mesh.part_count = 1; }), 0);
  EXPECT_EQ(add([&](sl_mesh& mesh) { mesh.parts = &unknown, mesh.part_count = 1; }), SL_ERROR_RANGE);
  EXPECT_EQ(add([&](sl_mesh& mesh) { mesh.parts = &beyond; }), SL_ERROR_RANGE);
  std::array<float, 24> positions = k_box_positions;
  positions[5] = k_nan;
  EXPECT_LT(add([&](sl_mesh& mesh) { mesh.positions = positions.data(); }), 0);
  EXPECT_EQ(add([](sl_mesh&) {}), SL_OK) << sl_last_error(scene.get());
}

TEST(CScene, RefusesObjectsAndMaterialsThatAreNone) {
  CScene scene;
  auto object = box_at(0, 0, 0, 1, 1, 1);
  object.mesh = 1;
  EXPECT_EQ(sl_scene_add_object(scene.get(), &object, nullptr), SL_ERROR_RANGE);
  object = box_at(std::nan(""), 0, 0, 1, 1, 1);
  EXPECT_EQ(sl_scene_add_object(scene.get(), &object, nullptr), SL_ERROR_NOT_FINITE);
  object = box_at(2e12, 0, 0, 1, 1, 1);
  EXPECT_EQ(sl_scene_add_object(scene.get(), &object, nullptr), SL_ERROR_NOT_FINITE);
  object = box_at(0, 0, 0, 1, 1, 1);
  object.world_from_object[3] = 1.0;
  EXPECT_EQ(sl_scene_add_object(scene.get(), &object, nullptr), SL_ERROR_MATRIX);
  object = box_at(0, 0, 0, 1, 1, 1);
  object.flags = 64;
  EXPECT_EQ(sl_scene_add_object(scene.get(), &object, nullptr), SL_ERROR_ARGUMENT);
  object.flags = SL_OBJECT_OCCLUDER_ONLY | SL_OBJECT_BLENDED;
  EXPECT_EQ(sl_scene_add_object(scene.get(), &object, nullptr), SL_ERROR_ARGUMENT);

  auto material = made<sl_material>();
  material.alpha = 3;
  EXPECT_EQ(sl_scene_add_material(scene.get(), &material, nullptr), SL_ERROR_ARGUMENT);
  material.alpha = SL_ALPHA_TESTED;
  material.texture_width = material.texture_height = 4;
  EXPECT_EQ(sl_scene_add_material(scene.get(), &material, nullptr), SL_ERROR_ARGUMENT);
  const std::uint8_t texel = 255;
  material.alpha_texture = &texel;
  material.texture_width = 20'000;
  EXPECT_LT(sl_scene_add_material(scene.get(), &material, nullptr), 0);
  material.texture_width = material.texture_height = 1;
  material.base_alpha = k_nan;
  EXPECT_LT(sl_scene_add_material(scene.get(), &material, nullptr), 0);
  material.base_alpha = 0.0f;
  std::uint32_t id = 0;
  EXPECT_EQ(sl_scene_add_material(scene.get(), &material, &id), SL_OK);
  EXPECT_EQ(id, 1u);
  EXPECT_EQ(sl_scene_create(2, nullptr), SL_ERROR_ARGUMENT);
  sl_scene none = nullptr;
  EXPECT_EQ(sl_scene_create(2, &none), SL_ERROR_ARGUMENT);
  EXPECT_EQ(none, nullptr);
}

TEST(CScene, HasNoMoreObjectsThanAClientCanHold) {
  CScene scene;
  EXPECT_EQ(sl_scene_set_spares(scene.get(), SL_MAX_OBJECTS + 1), SL_ERROR_FULL);
  EXPECT_EQ(sl_scene_set_spares(scene.get(), 0xffffffffu), SL_ERROR_FULL);
  EXPECT_EQ(sl_scene_set_spares(scene.get(), SL_MAX_OBJECTS), SL_OK);
  const auto object = box_at(0, 0, 0, 1, 1, 1);
  EXPECT_EQ(sl_scene_add_object(scene.get(), &object, nullptr), SL_ERROR_FULL);
}

TEST(CScene, IsFinishedByItsDigestAndOnlyOnce) {
  CScene scene;
  std::array<std::uint8_t, 16> first{}, second{};
  EXPECT_EQ(sl_scene_digest(scene.get(), first.data(), nullptr), SL_ERROR_ARGUMENT) << "no objects yet";
  const auto object = box_at(0, 0, -5, 1, 1, 1);
  scene.add(object);
  EXPECT_EQ(sl_scene_set_spares(scene.get(), 7), SL_OK);
  std::uint32_t count = 0;
  ASSERT_EQ(sl_scene_digest(scene.get(), first.data(), &count), SL_OK) << sl_last_error(scene.get());
  EXPECT_EQ(count, 8u);
  ASSERT_EQ(sl_scene_digest(scene.get(), second.data(), nullptr), SL_OK);
  EXPECT_EQ(first, second);
  const sl_mesh mesh = box_mesh();
  const auto material = made<sl_material>();
  EXPECT_EQ(sl_scene_add_object(scene.get(), &object, nullptr), SL_ERROR_ORDER);
  EXPECT_EQ(sl_scene_add_mesh(scene.get(), &mesh, nullptr), SL_ERROR_ORDER);
  EXPECT_EQ(sl_scene_add_material(scene.get(), &material, nullptr), SL_ERROR_ORDER);
  EXPECT_EQ(sl_scene_set_spares(scene.get(), 8), SL_ERROR_ORDER);
}

std::array<std::uint8_t, 16> digest_of(const CScene& scene) {
  std::array<std::uint8_t, 16> digest{};
  EXPECT_EQ(sl_scene_digest(scene.get(), digest.data(), nullptr), SL_OK) << sl_last_error(scene.get());
  return digest;
}

TEST(CScene, IsTheSameHoweverItsArraysLie) {
  CScene plain;
  plain.add(box_at(1, 2, -5, 1, 2, 3));
  // The same box with its positions among other things, and its indices in order.
  struct Vertex {
    float normal[3];
    float position[3];
  };
  std::vector<Vertex> vertices(8);
  for (std::size_t i = 0; i < 8; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) vertices[i].position[axis] = k_box_positions[3 * i + axis];
  }
  sl_scene strided = nullptr;
  ASSERT_EQ(sl_scene_create(SL_ROW_MAJOR, &strided), SL_OK);
  sl_mesh mesh = box_mesh();
  mesh.positions = vertices[0].position;
  mesh.position_stride = sizeof(Vertex);
  ASSERT_EQ(sl_scene_add_mesh(strided, &mesh, nullptr), SL_OK);
  auto object = box_at(1, 2, -5, 1, 2, 3);
  Matrix matrix{};
  std::copy(std::begin(object.world_from_object), std::end(object.world_from_object), matrix.begin());
  put(transposed(matrix), object.world_from_object);
  ASSERT_EQ(sl_scene_add_object(strided, &object, nullptr), SL_OK);
  std::array<std::uint8_t, 16> digest{};
  ASSERT_EQ(sl_scene_digest(strided, digest.data(), nullptr), SL_OK);
  EXPECT_EQ(digest, digest_of(plain));
  sl_scene_destroy(strided);

  CScene other;
  other.add(box_at(1, 2, -5, 1, 2, 3.5));
  EXPECT_NE(digest, digest_of(other));
}

}  // namespace
}  // namespace sightline::testing
