// Needles: triangles whose corners lie on one line. OpenGL may give a pixel of theirs the depth of the near
// plane, whatever hides the object.

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "common/gl/gpu_scene.hpp"
#include "common/pose.hpp"
#include "control_view/engines/item_buffer_engine.hpp"
#include "control_view/engines/raster/needle_index.hpp"
#include "control_view/engines/raster/raster_engine.hpp"
#include "control_view/engines/raster/raster_view.hpp"
#include "tests/common/test_scenes.hpp"
#include "tests/control_view/engine_counts.hpp"
#include "tests/control_view/plain_raster.hpp"
#include "tests/control_view/plain_raster_triangle.hpp"

namespace sightline {
namespace {

using raster::Needle;
using raster::NeedleIndex;
using test::count;
using test::difference;
using test::plain_counts;
using test::with_threads;

/// A needle of a real building, and a view in which it shows one pixel through what hides the building.
struct NeedleCase {
  const char* name;
  std::array<glm::vec3, 3> corners;
  Pose pose;
  ImageSize size;
};

std::array<NeedleCase, 3> needle_cases() {
  return {{
      {"roof 550 m away",
       {{{527.252014f, 29.2000008f, 216.923401f},
         {525.428772f, 29.2000008f, 219.580688f},
         {529.494995f, 29.2000008f, 213.654526f}}},
       {{553.98782937081273, 1.773760031799364, 811.30356929341417},
        {0.98561196735718615, -0.022522505272796513, -0.16747280540387421, -0.0038270104115235883}},
       {1024, 768}},
      {"roof 1,190 m away",
       {{{916.828186f, 13.4000015f, -600.911804f},
         {920.250488f, 13.4000015f, -597.12207f},
         {914.682922f, 13.4000015f, -603.287842f}}},
       {{396.12414999999999, 1.7702500000000001, 563.16205000000002},
        {0.99921250513721127, -0.024392700125409214, -0.031285500160846892, -0.00076370000392638035}},
       {512, 384}},
      {"fitting 7 m away",
       {{{7.98838234f, 1.30455327f, -31.6396904f},
         {7.98999023f, 1.30455327f, -31.6386795f},
         {7.99159813f, 1.30455327f, -31.6376724f}}},
       {{5.8978099999999998, 1.58087, -24.982700000000001},
        {-0.99999869653896956, -0.0010237999964565925, -0.0012484999956788978, 1.2999999955006546e-06}},
       {512, 384}},
  }};
}

Eye eye_of(const Pose& pose, ImageSize size) {
  return {camera_from_world(pose), clip_from_camera(Perspective{}, double(size.width) / size.height)};
}

constexpr ObjectId k_wall{0}, k_needle{1};

void add_mesh(Scene& scene, const std::vector<glm::vec3>& corners, std::uint32_t material) {
  const auto first_index = static_cast<std::uint32_t>(scene.indices.size());
  for (const glm::vec3& corner : corners) {
    scene.indices.push_back(static_cast<std::uint32_t>(scene.positions.size()));
    scene.positions.push_back(corner);
  }
  scene.primitives.push_back({first_index, static_cast<std::uint32_t>(corners.size()), material});
  scene.meshes.push_back({static_cast<std::uint32_t>(scene.primitives.size()) - 1, 1, {}});
}

/// The needle, a wall two metres before the eye that covers the view, and the middle of the world, so that
/// the scene's frame is the world's.
Scene scene_of(const NeedleCase& picture, const Material& material,
               const glm::dmat4& placement = glm::dmat4(1.0)) {
  Scene scene;
  scene.materials = {testing::double_sided(), material};
  std::vector<glm::vec3> wall;
  const glm::dmat4 world_from_camera = glm::inverse(camera_from_world(picture.pose));
  for (const glm::dvec2& at : {glm::dvec2(-3, -3), glm::dvec2(3, -3), glm::dvec2(3, 3), glm::dvec2(-3, -3),
                               glm::dvec2(3, 3), glm::dvec2(-3, 3)}) {
    wall.emplace_back(world_from_camera * glm::dvec4(at, -2.0, 1.0));
  }
  add_mesh(scene, wall, 0);
  add_mesh(scene, {picture.corners.begin(), picture.corners.end()}, 1);
  add_mesh(scene, {{-2000, 0, -2000}, {2000, 0, -2000}, {2000, 0, 2000}}, 0);
  scene.objects = {{0, glm::dmat4(1.0)}, {1, placement}, {2, glm::translate(glm::dmat4(1.0), {0, -100, 0})}};
  finish_scene(scene, "needle");
  return scene;
}

class RasterNeedles : public ::testing::TestWithParam<std::string_view> {};

TEST_P(RasterNeedles, ShowThroughWhatHidesTheirObjectAsInOpenGl) {
  for (const NeedleCase& picture : needle_cases()) {
    for (const Material& material : {testing::opaque(), testing::glass()}) {
      const Scene scene = scene_of(picture, material);
      const Eye eye = eye_of(picture.pose, picture.size);
      const PixelCounts expected = plain_counts(scene, {&eye, 1}, picture.size);
      ASSERT_TRUE(std::binary_search(expected.ids.begin(), expected.ids.end(), k_needle)) << picture.name;
      for (const std::uint32_t threads : {1u, 3u}) {
        const auto engine = make_raster_engine(scene, with_threads(threads), GetParam());
        for (int look = 0; look < 2; ++look) {
          const PixelCounts counted = count(*engine, eye, picture.size);
          EXPECT_TRUE(counted == expected) << picture.name << difference(counted, expected);
        }
      }
    }
  }
}

TEST_P(RasterNeedles, ShowWhereTheirObjectWasMovedTo) {
  const NeedleCase picture = needle_cases()[0];
  const Scene there = scene_of(picture, testing::opaque());
  const Scene elsewhere = scene_of(picture, testing::opaque(), glm::translate(glm::dmat4(1.0), {40, 3, 90}));
  const Eye eye = eye_of(picture.pose, picture.size);
  const PixelCounts expected = plain_counts(there, {&eye, 1}, picture.size);
  const PixelCounts without = plain_counts(elsewhere, {&eye, 1}, picture.size);
  ASSERT_NE(expected.ids, without.ids);

  const auto engine = make_raster_engine(elsewhere, with_threads(1), GetParam());
  EXPECT_TRUE(count(*engine, eye, picture.size) == without);
  SceneEdits edits{1, 1, {{k_needle, glm::dmat4x3(1.0)}}};
  engine->apply(edits);
  EXPECT_TRUE(count(*engine, eye, picture.size) == expected);
  edits.version = 2;
  edits.hidden = {k_needle};
  engine->apply(edits);
  EXPECT_TRUE(count(*engine, eye, picture.size) == without);
  engine->apply({2, 1, {}});
  EXPECT_TRUE(count(*engine, eye, picture.size) == without);
}

TEST_P(RasterNeedles, ShowInTheWindowThatHoldsThem) {
  const NeedleCase picture = needle_cases()[2];
  const Scene scene = scene_of(picture, testing::opaque());
  const Eye eye = eye_of(picture.pose, picture.size);
  const auto engine = make_raster_engine(scene, with_threads(2), GetParam());
  const auto shows_in = [&](std::uint32_t x, std::uint32_t y) {
    const PixelCounts counts = count(*engine, {&eye, 1}, {64, 64}, ImageWindow{picture.size, x, y});
    return std::binary_search(counts.ids.begin(), counts.ids.end(), k_needle);
  };
  EXPECT_TRUE(shows_in(361 - 63, 177 - 63));
  EXPECT_TRUE(shows_in(361, 177));
  EXPECT_FALSE(shows_in(362, 177));
  EXPECT_FALSE(shows_in(361, 178));
}

TEST_P(RasterNeedles, AreExplainedAsTheyShow) {
  const NeedleCase picture = needle_cases()[0];
  const Scene scene = scene_of(picture, testing::opaque());
  const Eye eye = eye_of(picture.pose, picture.size);
  const auto engine = make_raster_engine(scene, with_threads(1), GetParam());
  const Explanation explanation = engine->explain({{&eye, 1}, picture.size, {}}, k_needle);
  EXPECT_EQ(explanation.alone_px, 1u);
  EXPECT_EQ(explanation.shown_px, 1u);
}

INSTANTIATE_TEST_SUITE_P(OfThisMachine, RasterNeedles, ::testing::ValuesIn(raster_instruction_sets()),
                         [](const auto& set) { return std::string(set.param); });

std::vector<Needle> find(NeedleIndex& index, const Scene& scene, const Eye& eye, ImageSize size) {
  std::vector<Needle> found;
  index.find(raster::best_kernel(), raster::view_of(eye, scene.world_origin_m, size),
             {0, 0, static_cast<std::int32_t>(size.width), static_cast<std::int32_t>(size.height)}, found);
  return found;
}

TEST(NeedleIndexTest, HoldsNoTriangleThatIsNotThin) {
  const NeedleCase picture = needle_cases()[0];
  NeedleIndex index(scene_of(picture, testing::opaque()));
  ASSERT_EQ(index.triangles().size(), 1u);
  EXPECT_EQ(index.triangles()[0].primitive, 1u);
}

TEST(ItemBufferNeedles, ShowThroughWhatHidesTheirObject) {
  for (const NeedleCase& picture : needle_cases()) {
    for (const Material& material : {testing::opaque(), testing::glass()}) {
      const Scene scene = scene_of(picture, material);
      const Eye eye = eye_of(picture.pose, picture.size);
      const PixelCounts expected = count(*make_item_buffer_all_engine(scene, {}), eye, picture.size);
      const auto engine = make_item_buffer_engine(scene, {});
      for (int look = 0; look < 2; ++look) {
        const PixelCounts counted = count(*engine, eye, picture.size);
        EXPECT_TRUE(counted == expected) << picture.name << difference(counted, expected);
      }
    }
  }
}

/// Sills about as high as the eye, cut between corners that others put on their edges: three corners in a
/// row, as far as floats hold that.
Scene many_needles(std::mt19937& random) {
  const auto between = [&random](float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(random);
  };
  Scene scene;
  scene.materials = {testing::double_sided()};
  for (int i = 0; i < 3000; ++i) {
    // Of few bits, so that the middle corner is exactly in the middle.
    const auto coarse = [&](float low, float high) {
      return std::round(4096.0f * between(low, high)) / 4096.0f;
    };
    const glm::vec3 start(coarse(-60.0f, 60.0f), coarse(-0.5f, 0.5f), coarse(-90.0f, -20.0f));
    const glm::vec3 step(coarse(-0.03f, 0.03f), 0.0f, coarse(-0.03f, 0.03f));
    add_mesh(scene, {start, start + step, start + 2.0f * step}, 0);
    scene.objects.push_back({static_cast<std::uint32_t>(i), glm::dmat4(1.0)});
  }
  finish_scene(scene, "needles");
  return scene;
}

TEST(NeedleIndexTest, FindsWhateverGoesAstray) {
  std::mt19937 random(5);
  const Scene scene = many_needles(random);
  NeedleIndex index(scene);
  ASSERT_EQ(index.triangles().size(), 3000u);
  constexpr ImageSize size{1024, 768};
  int astray = 0;
  std::size_t found_needles = 0, looked_at = 0;
  for (int view = 0; view < 300; ++view) {
    Pose pose;
    pose.position_m = {0.055 * view - 8.0, 0.001 * view, 0.03 * view};
    const Eye eye = eye_of(pose, size);
    const glm::mat4 clip_from_scene = gl::depth_clip_from_scene(eye, scene.world_origin_m);
    const std::vector<Needle> found = find(index, scene, eye, size);
    found_needles += found.size();
    looked_at += scene.object_count();
    for (std::uint32_t object = 0; object < scene.object_count(); ++object) {
      std::array<test::PlainVertex, 3> corners;
      float nearest = 0.0f;
      for (std::uint32_t corner = 0; corner < 3; ++corner) {
        corners[corner] = test::plain_vertex(clip_from_scene, glm::mat4(1.0f),
                                             scene.positions[3 * object + corner], {}, size);
        nearest = std::max(nearest, corners[corner].window.z);
      }
      test::draw_triangles(corners, {true, false}, size, [&](const test::PlainFragment& fragment) {
        if (!(fragment.depth > 1.05f * nearest)) return;
        ++astray;
        const bool is_found = std::any_of(found.begin(), found.end(),
                                          [object](const Needle& needle) { return needle.object == object; });
        EXPECT_TRUE(is_found) << "view " << view << ", needle " << object;
      });
    }
  }
  EXPECT_GT(astray, 0);
  EXPECT_LT(found_needles, looked_at / 50) << "much is drawn in vain";
}

/// One mesh of all the corners, in objects of these placements; a plane of 400 m besides.
Scene scene_with(const std::vector<glm::vec3>& corners, const std::vector<glm::dmat4>& placements) {
  Scene scene;
  scene.materials = {testing::double_sided()};
  add_mesh(scene, corners, 0);
  add_mesh(scene, {{-200, 0, -200}, {200, 0, -200}, {200, 0, 200}}, 0);
  for (const glm::dmat4& placement : placements) scene.objects.push_back({0, placement});
  scene.objects.push_back({1, glm::dmat4(1.0)});
  finish_scene(scene, "placed");
  return scene;
}

std::vector<glm::vec3> triangles_of_25_cm(std::uint32_t count, float height_m) {
  std::vector<glm::vec3> corners;
  for (std::uint32_t i = 0; i < count; ++i) {
    const glm::vec3 at(0.5f * static_cast<float>(i % 64), 0.0f, 0.5f * static_cast<float>(i / 64));
    corners.insert(corners.end(), {at, at + glm::vec3(0.25f, 0, 0), at + glm::vec3(0.125f, 0, height_m)});
  }
  return corners;
}

TEST(NeedleIndexTest, KeepsAsManyAsItMayOfThoseThatAreThinnest) {
  std::vector<glm::vec3> corners = triangles_of_25_cm(100, 0.0f);
  for (std::size_t i = 0; i < 30; ++i) corners[3 * i + 2].z += 1e-5f;  // not quite on the line
  const Scene scene = scene_with(corners, {glm::dmat4(1.0)});
  EXPECT_EQ(NeedleIndex(scene).triangles().size(), 100u);
  const NeedleIndex few(scene, 70);
  ASSERT_EQ(few.triangles().size(), 70u);
  for (const raster::MeshTriangle& triangle : few.triangles()) EXPECT_GE(triangle.first_index, 90u);
  EXPECT_EQ(NeedleIndex(scene, 20).triangles().size(), 20u);
}

TEST(NeedleIndexTest, HoldsNothingThatIsShrunkToAPoint) {
  const Scene scene =
      scene_with(triangles_of_25_cm(500, 0.25f), {glm::scale(glm::dmat4(1.0), glm::dvec3(0.0))});
  EXPECT_TRUE(NeedleIndex(scene).triangles().empty());
}

TEST(NeedleIndexTest, HoldsNoSmallTrianglesOfAVastScene) {
  Scene scene = scene_with(triangles_of_25_cm(500, 0.2f), {glm::dmat4(1.0)});
  scene.objects.push_back({1, glm::scale(glm::dmat4(1.0), glm::dvec3(1e4))});
  finish_scene(scene, "sky");
  EXPECT_TRUE(NeedleIndex(scene).triangles().empty());
}

TEST(NeedleIndexTest, HoldsWhatAPlacementSqueezesOntoALine) {
  glm::dmat4 sheared(1.0);
  for (const double left : {0.0, 1e-9}) {
    sheared[2] = glm::dvec4(1.0, 0.0, left, 0.0);  // columns as long as ever
    const Scene scene = scene_with({{0, 0, 0}, {1, 0, 0}, {0.5f, 0, 0.25f}}, {sheared, glm::dmat4(1.0)});
    EXPECT_EQ(NeedleIndex(scene).triangles().size(), 1u) << left;
  }
}

TEST(NeedleIndexTest, FindsNoMoreWhereAnotherIsFarAway) {
  std::mt19937 random(7);
  Scene scene = many_needles(random);
  NeedleIndex index(scene);
  constexpr ImageSize size{512, 384};
  const Eye eye = eye_of(Pose{{0, 0, 3}, {}}, size);
  const std::size_t near = find(index, scene, eye, size).size();
  const ObjectId parked{17};
  const glm::dmat4 far_away = glm::translate(glm::dmat4(1.0), glm::dvec3(1e6, 0, 0));
  index.move({&parked, 1}, {&far_away, 1});
  EXPECT_LE(find(index, scene, eye, size).size(), near + 32);  // its group's
}

}  // namespace
}  // namespace sightline
