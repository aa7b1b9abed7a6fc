#include <cmath>
#include <string>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "common/camera_path.hpp"
#include "common/scene/load_scene.hpp"
#include "control_view/engines/item_buffer_engine.hpp"
#include "control_view/engines/raster/raster_engine.hpp"
#include "tests/common/test_scenes.hpp"
#include "tests/control_view/engine_counts.hpp"
#include "tests/control_view/plain_raster.hpp"

namespace sightline {
namespace {

using sightline::testing::SceneBuilder;
using sightline::testing::shared_folder;
using test::count;
using test::difference;
using test::plain_counts;
using test::with_threads;

/// A ball of many clusters; `rings` x 2 `rings` quads.
std::uint32_t add_ball_mesh(Scene& scene, int rings, float radius_m) {
  const auto first_vertex = static_cast<std::uint32_t>(scene.positions.size());
  const auto first_index = static_cast<std::uint32_t>(scene.indices.size());
  const auto columns = static_cast<std::uint32_t>(2 * rings);
  for (int ring = 0; ring <= rings; ++ring) {
    const double polar = 3.14159265358979 * ring / rings;
    for (std::uint32_t column = 0; column < columns; ++column) {
      const double turn = 2.0 * 3.14159265358979 * column / columns;
      scene.positions.emplace_back(radius_m * std::sin(polar) * std::cos(turn), radius_m * std::cos(polar),
                                   -radius_m * std::sin(polar) * std::sin(turn));
    }
  }
  for (std::uint32_t ring = 0; ring < static_cast<std::uint32_t>(rings); ++ring) {
    for (std::uint32_t column = 0; column < columns; ++column) {
      const std::uint32_t a = first_vertex + ring * columns + column;
      const std::uint32_t b = first_vertex + ring * columns + (column + 1) % columns;
      for (const std::uint32_t index : {a, a + columns, b, b, a + columns, b + columns}) {
        scene.indices.push_back(index);
      }
    }
  }
  scene.primitives.push_back(
      {first_index, static_cast<std::uint32_t>(scene.indices.size()) - first_index, 0});
  scene.meshes.push_back({static_cast<std::uint32_t>(scene.primitives.size()) - 1, 1, {}});
  return static_cast<std::uint32_t>(scene.meshes.size()) - 1;
}

TEST(RasterEngine, LosesNoClusterFarFromTheScenesOrigin) {
  // Large coordinates that cancel: what is near the eye is known to a millimetre at best.
  Scene scene;
  scene.materials.push_back(testing::opaque());
  const std::uint32_t ball = add_ball_mesh(scene, 24, 1.0f);
  const glm::dvec3 place(900.0, 40.0, -950.0);
  for (int i = 0; i < 40; ++i) {
    const glm::dvec3 offset(0.9 * (i % 8) - 3.2, 0.9 * (i / 8) - 1.8, -0.35 * (i % 5));
    const glm::dmat4 turned = glm::rotate(glm::dmat4(1.0), 0.7 * i, glm::dvec3(0.3, 1.0, 0.2));
    scene.objects.push_back({ball, glm::translate(glm::dmat4(1.0), place + offset) * turned});
  }
  // Holds the scene's centre, so that its frame is not moved to the balls.
  scene.objects.push_back({ball, glm::translate(glm::dmat4(1.0), -place)});
  finish_scene(scene, "balls");
  const auto engine = make_raster_engine(scene, with_threads(1));
  for (const double distance_m : {3.0, 6.0, 30.0}) {
    const glm::dvec3 from = place + glm::dvec3(0.4, 0.3, distance_m);
    const Eye eye{glm::lookAt(from, place, glm::dvec3(0.0, 1.0, 0.0)), clip_from_camera(Perspective{}, 1.5)};
    for (int look = 0; look < 2; ++look) {
      const PixelCounts counted = count(*engine, eye, {240, 160});
      const PixelCounts expected = plain_counts(scene, {&eye, 1}, {240, 160});
      EXPECT_TRUE(counted == expected) << distance_m << " m:" << difference(counted, expected);
    }
  }
}

/// Balls side by side, and an eye that sees some of each.
struct Balls {
  explicit Balls(int objects) {
    scene.materials.push_back(testing::opaque());
    const std::uint32_t ball = add_ball_mesh(scene, 20, 1.0f);
    for (int i = 0; i < objects; ++i) {
      const glm::dvec3 place(0.8 * (i % 5) - 1.6, 0.8 * (i / 5) - 1.0, -6.0 - 0.3 * (i % 3));
      scene.objects.push_back({ball, glm::translate(glm::dmat4(1.0), place)});
    }
    finish_scene(scene, "balls");
  }
  Scene scene;
  Eye eye{glm::dmat4(1.0), clip_from_camera(Perspective{}, 1.5)};
};

TEST(RasterEngine, CountsTheSameWhereClustersShareARank) {
  const Balls balls(15);
  const auto engine =
      make_raster_engine(balls.scene, with_threads(2), raster_instruction_sets().front(), /*most_ranks=*/40);
  const PixelCounts expected = plain_counts(balls.scene, {&balls.eye, 1}, {240, 160});
  for (int look = 0; look < 3; ++look) {
    const PixelCounts counted = count(*engine, balls.eye, {240, 160});
    EXPECT_TRUE(counted == expected) << difference(counted, expected);
  }
}

TEST(RasterEngine, MissesNoSurfaceSeenEdgeOnBehindAnother) {
  // Walls that run away from the eye and begin a hand's breadth behind what hides them: pixel centres beside
  // them, within what snapping moves an edge by, show a depth nearer than any of their corners.
  SceneBuilder builder;
  const auto stone = builder.add_material(testing::double_sided());
  builder.add_wall({0, 0, -5}, 8.0, 2.0, stone);
  for (int i = 0; i < 60; ++i) {
    builder.add_wall({-3.0 + 0.1 * i, 0.0, -32.6}, 55.0, 4.0, stone, 1.5707963267948966);
  }
  const Scene scene = builder.finish();
  const auto engine = make_raster_engine(scene, with_threads(1));
  for (int view = 0; view < 60; ++view) {
    Pose pose;
    pose.position_m = {0.013 * view - 0.4, 0.007 * view, 0.0};
    const Eye eye{camera_from_world(pose), clip_from_camera(Perspective{}, 4.0 / 3.0)};
    const PixelCounts counted = count(*engine, eye, {320, 240});
    const PixelCounts expected = plain_counts(scene, {&eye, 1}, {320, 240});
    EXPECT_TRUE(counted == expected) << "view " << view << ":" << difference(counted, expected);
  }
}

/// Views along a path of ../shared/scenes.
class RasterOnSharedScene : public ::testing::TestWithParam<const char*> {};

TEST_P(RasterOnSharedScene, CountsWhatTheItemBufferCounts) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << "needs ../shared/scenes";
  const std::string name = GetParam();
  const Scene scene = load_scene((*shared / "scenes" / (name + ".glb")).string(), {.shading = false});
  const CameraPath path = read_camera_path((*shared / "scenes" / (name + ".path.csv")).string());
  const auto reference = make_item_buffer_all_engine(scene, {});
  const auto engine = make_raster_engine(scene, with_threads(2));
  constexpr ImageSize size{512, 384};
  for (int view = 0; view < 4; ++view) {
    const Eye eye{camera_from_world(path.at(7.0 + 13.0 * view)), clip_from_camera(Perspective{}, 4.0 / 3.0)};
    const PixelCounts expected = count(*reference, eye, size);
    const PixelCounts counted = count(*engine, eye, size);
    EXPECT_TRUE(counted == expected) << "view " << view << ":" << difference(counted, expected);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, RasterOnSharedScene,
                         ::testing::Values("rotterdam", "denhaag01", "clinic", "walker_assembly"),
                         [](const auto& set) { return std::string(set.param); });

}  // namespace
}  // namespace sightline
