#include "common/scene/scene.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "tests/common/test_scenes.hpp"

namespace sightline {
namespace {

using testing::SceneBuilder;

Scene two_boxes() {
  SceneBuilder builder;
  const auto stone = builder.add_material(testing::opaque());
  builder.add_box({0, 0, -5}, {1, 1, 1}, stone);
  builder.add_box({2, 0, -5}, {1, -2, 1}, stone);
  return builder.finish();
}

TEST(FinishScene, BoundsEveryObject) {
  const Scene scene = two_boxes();
  EXPECT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.triangle_count(), 24u);
  EXPECT_NEAR(scene.object_bounds[1].max.y, 1.0f, 1e-4f);
  EXPECT_NEAR(scene.bounds.min.x, -0.5f, 1e-4f);
  EXPECT_NEAR(scene.bounds.max.x, 2.5f, 1e-4f);
}

TEST(FinishScene, ChangesNothingTheSecondTime) {
  Scene scene = two_boxes();
  scene.objects[0].scene_from_object[3].x = 5000.0;
  scene.objects[1].scene_from_object[3].x = 5002.0;
  finish_scene(scene, "test");
  EXPECT_EQ(scene.world_origin_m.x, 5001.0);
  const SceneDigest digest = scene.digest;
  finish_scene(scene, "test");
  EXPECT_EQ(scene.digest, digest);
}

template <class Bend>
void expect_refused(Bend bend) {
  Scene scene = two_boxes();
  bend(scene);
  EXPECT_THROW(finish_scene(scene, "bent"), InputError);
}

TEST(FinishScene, RefusesWhatBreaksARule) {
  expect_refused([](Scene& s) { s.indices[3] = static_cast<std::uint32_t>(s.positions.size()); });
  expect_refused([](Scene& s) { s.positions[1].y = std::nanf(""); });
  expect_refused([](Scene& s) { s.positions.back().z = HUGE_VALF; });
  expect_refused([](Scene& s) { s.normals.pop_back(); });
  expect_refused([](Scene& s) { s.uvs[0].x = std::nanf(""); });
  expect_refused([](Scene& s) { s.objects[0].scene_from_object[1][1] = std::nan(""); });
  expect_refused([](Scene& s) { s.objects[0].scene_from_object[1][3] = 1.0; });
  expect_refused([](Scene& s) {
    s.objects[0].scene_from_object[3].x = 1e39;
    s.world_origin_m.x = 1;
  });
  expect_refused([](Scene& s) { s.objects[1].mesh = 9; });
  expect_refused([](Scene& s) { s.meshes[0].primitive_count = 9; });
  expect_refused([](Scene& s) { s.primitives[0].index_count = 4; });
  expect_refused([](Scene& s) { s.primitives[0].index_count = 3000; });
  expect_refused([](Scene& s) { s.primitives[0].material = 9; });
  expect_refused([](Scene& s) { s.materials[0].texture = 0; });
  expect_refused([](Scene& s) { s.materials[0].base_color.x = std::nanf(""); });
  expect_refused([](Scene& s) { s.textures.push_back({2, 2, true, true, {1, 2, 3}}); });
  expect_refused([](Scene& s) {
    s.objects.clear();
    s.object_names.clear();
  });
  expect_refused([](Scene& s) { s.object_names.pop_back(); });
}

TEST(SceneBuilder, TurnsEveryFaceOutwards) {
  const Scene scene = two_boxes();
  for (std::size_t i = 0; i < scene.indices.size(); i += 3) {
    const glm::vec3 a = scene.positions[scene.indices[i]];
    const glm::vec3 b = scene.positions[scene.indices[i + 1]];
    const glm::vec3 c = scene.positions[scene.indices[i + 2]];
    EXPECT_GT(glm::dot(glm::cross(b - a, c - a), a + b + c), 0.0f);
  }
}

TEST(SceneBuilder, FacesWallsForwardsAndGroundUpwards) {
  SceneBuilder builder;
  const auto stone = builder.add_material(testing::opaque());
  builder.add_wall({0, 0, 0}, 2, 4, stone);
  builder.add_ground({0, -1, 0}, 6, 8, stone);
  const Scene scene = builder.finish();
  const auto normal = [&](std::size_t object) {
    return glm::dvec3(scene.objects[object].scene_from_object * glm::dvec4(0, 0, 1, 0));
  };
  EXPECT_EQ(normal(0), glm::dvec3(0, 0, 1));
  EXPECT_EQ(normal(1), glm::dvec3(0, 1, 0));
  EXPECT_GT(glm::determinant(scene.objects[1].scene_from_object), 0.0);
  EXPECT_NEAR(scene.object_bounds[1].extent().z, 8.0f, 1e-3f);
}

}  // namespace
}  // namespace sightline
