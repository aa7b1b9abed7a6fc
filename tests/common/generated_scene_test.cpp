#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/scene/generate_city.hpp"
#include "common/scene/generate_crowd.hpp"
#include "common/scene/load_scene.hpp"
#include "common/scene/write_glb.hpp"
#include "tests/common/test_scenes.hpp"

namespace sightline {
namespace {

/// Distance from the walk to the nearest thing that stands up.
double nearest_m(const Scene& scene, const CameraPath& path) {
  double nearest = 1e9;
  for (std::size_t i = 0; i < path.samples.size(); i += 4) {
    const glm::dvec3 eye = path.samples[i].pose.position_m;
    for (const Aabb& box : scene.object_bounds) {
      if (box.extent().y < 0.1f) continue;
      nearest =
          std::min(nearest, glm::distance(eye, glm::clamp(eye, glm::dvec3(box.min), glm::dvec3(box.max))));
    }
  }
  return nearest;
}

void expect_smooth(const CameraPath& path) {
  EXPECT_EQ(path.samples.size(), 3601u);
  EXPECT_NEAR(path.duration_s(), 60.0, 1e-9);
  for (std::size_t i = 1; i < path.samples.size(); ++i) {
    const Pose& a = path.samples[i - 1].pose;
    const Pose& b = path.samples[i].pose;
    EXPECT_NEAR(b.position_m.y, 1.7, 1e-9);
    EXPECT_LT(glm::distance(a.position_m, b.position_m), 0.12);  // 7 m/s
    EXPECT_LT(rotation_angle_rad(a.world_from_camera, b.world_from_camera), 0.06);
  }
}

TEST(GeneratedCity, HasExactlyTheObjectsAskedForAndAboutTheirTriangles) {
  for (const std::uint32_t count : {1u, 39u, 41u, 2000u, 12345u}) {
    EXPECT_EQ(generate_city(count, 1).object_count(), count);
    EXPECT_EQ(generate_crowd(count, 1).object_count(), count);
  }
  EXPECT_NEAR(static_cast<double>(generate_city(2000, 1).triangle_count()), 258000.0, 20000.0);
  EXPECT_THROW((void)generate_city(0, 1), InputError);
  EXPECT_THROW((void)generate_crowd(0, 1), InputError);
}

TEST(GeneratedCity, FollowsItsSeedAlone) {
  EXPECT_EQ(generate_city(2000, 7).digest, generate_city(2000, 7).digest);
  EXPECT_NE(generate_city(2000, 7).digest, generate_city(2000, 8).digest);
  EXPECT_EQ(generate_crowd(2000, 7).digest, generate_crowd(2000, 7).digest);
  EXPECT_NE(generate_crowd(2000, 7).digest, generate_crowd(2000, 8).digest);
}

TEST(GeneratedCity, SharesItsMeshesAtAnySize) {
  EXPECT_EQ(generate_city(100000, 1).geometry_bytes(), generate_city(1000, 1).geometry_bytes());
}

TEST(GeneratedCity, IsWalkedWithoutTouchingAnything) {
  for (const std::uint32_t count : {40u, 400u, 2000u, 4000u}) {
    expect_smooth(city_path(count, 3));
    EXPECT_GT(nearest_m(generate_city(count, 3), city_path(count, 3)), 1.5) << count;
  }
}

TEST(GeneratedCrowd, IsWalkedWithoutTouchingAnything) {
  for (const std::uint32_t count : {80u, 400u, 2000u, 4000u}) {
    expect_smooth(crowd_path(count, 3));
    EXPECT_GT(nearest_m(generate_crowd(count, 3), crowd_path(count, 3)), 0.4) << count;
  }
}

TEST(WriteGlb, ReadsBackToAnEqualScene) {
  const testing::TemporaryFolder folder;
  for (const Scene& scene : {generate_city(2000, 5), generate_crowd(2000, 5)}) {
    write_glb(folder / "scene.glb", scene);
    const Scene again = load_scene(folder / "scene.glb");
    EXPECT_EQ(again.digest, scene.digest);
    EXPECT_EQ(again.object_bounds, scene.object_bounds);
    EXPECT_EQ(load_scene(folder / "scene.glb", {.shading = false}).digest, scene.digest);
  }
}

TEST(WriteGlb, ReadsBackScenesThatLeaveMeshesUnused) {
  const testing::TemporaryFolder folder;
  for (const std::uint32_t count : {1u, 2u, 10u, 50u, 100u}) {
    for (const Scene& scene : {generate_city(count, 5), generate_crowd(count, 5)}) {
      write_glb(folder / "scene.glb", scene);
      EXPECT_EQ(load_scene(folder / "scene.glb").digest, scene.digest) << count;
      EXPECT_EQ(load_scene(folder / "scene.glb", {.shading = false}).digest, scene.digest) << count;
    }
  }
}

TEST(WriteGlb, KeepsMaterialsTexturesNamesAndADistantOrigin) {
  testing::SceneBuilder builder;
  const auto mask = builder.add_checker_mask();
  const auto pane = builder.add_material(testing::glass());
  builder.add_box({3e6, 0.1, -2e6}, {1, 2, 3}, mask);
  builder.add_box({3e6 + 5.3, 0.1, -2e6}, {-1, 2, 3}, pane);
  builder.add_wall({3e6 + 9.7, 1, -2e6}, 2, 2, pane, 0.3);
  const Scene scene = builder.finish();
  EXPECT_NE(scene.world_origin_m, glm::dvec3(0.0));
  const testing::TemporaryFolder folder;
  write_glb(folder / "scene.glb", scene);
  const Scene again = load_scene(folder / "scene.glb");
  EXPECT_EQ(again.digest, scene.digest);
  EXPECT_EQ(again.materials, scene.materials);
  EXPECT_EQ(again.textures[0].rgba, scene.textures[0].rgba);
  EXPECT_EQ(again.object_names, scene.object_names);
  EXPECT_EQ(again.world_origin_m, scene.world_origin_m);
  EXPECT_THROW(write_glb("/nonexistent/scene.glb", scene), InputError);
}

}  // namespace
}  // namespace sightline
