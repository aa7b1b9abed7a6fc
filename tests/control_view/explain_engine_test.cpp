// Why the engine `raster` says a view shows an object or does not, against two images of the plain
// rasterizer.

#include <algorithm>
#include <sstream>

#include <gtest/gtest.h>

#include "control_view/engines/raster/raster_engine.hpp"
#include "tests/common/test_scenes.hpp"
#include "tests/control_view/engine_counts.hpp"
#include "tests/control_view/plain_explanation.hpp"
#include "tests/control_view/raster_cases.hpp"
#include "tests/gl/random_scene.hpp"

namespace sightline {
namespace {

using namespace test;
using testing::SceneBuilder;

constexpr ImageSize k_size{150, 110};  // no multiple of a block

Eye straight_ahead() {
  return {glm::dmat4(1.0), clip_from_camera(Perspective{}, double(k_size.width) / k_size.height)};
}

std::string text_of(const Explanation& explanation) {
  std::ostringstream text;
  text << explanation.shown_px << " of " << explanation.alone_px << " show, hidden by";
  for (const Blocker& blocker : explanation.hidden_by) {
    text << ' ' << index_of(blocker.id) << ':' << blocker.pixels;
  }
  return text.str();
}

SceneEdits edits_of(std::uint64_t owner, std::uint64_t version) {
  SceneEdits edits;
  edits.owner = owner;
  edits.version = version;
  return edits;
}

/// The same pixel for pixel, where the object has any at the query's own size.
void expect_as_plain(const Explanation& found, const Explanation& plain, const std::string& what) {
  EXPECT_TRUE(found.known);
  if (plain.alone_px == 0) {
    EXPECT_TRUE(found.alone_px == 0 || found.scale > 1) << what << ": " << text_of(found);
    return;
  }
  EXPECT_TRUE(found.in_field) << what;
  EXPECT_EQ(found.scale, 1u) << what;
  EXPECT_EQ(text_of(found), text_of(plain)) << what;
}

TEST(ExplainItemBuffer, NamesWhatThePlainRasterizerFindsPixelForPixel) {
  const Scene scene = testing::random_scene(9, 70);
  for (const char* name : {"item_buffer", "item_buffer_all"}) {
    EngineOptions options = with_threads(1);
    options.engine = name;
    const auto engine = make_engine(scene, options);
    const std::vector<Eye> eyes{testing::eye_at({0, 0, 15}, 0.0, 0.0, k_size)};
    for (std::uint32_t i = 0; i < scene.object_count(); i += 2) {
      const Explanation plain = plain_explanation(scene, eyes, ObjectId{i}, k_size);
      expect_as_plain(engine->explain({eyes, k_size, {}}, ObjectId{i}), plain,
                      std::to_string(i) + " of " + name);
    }
    const std::vector<BoxedObject> ahead{{ObjectId{3}, {{-30, -30, -80}, {30, 30, -60}}}},
        behind{{ObjectId{3}, {{-1, -1, 60}, {1, 1, 80}}}};
    ViewQuery query{eyes, k_size, {}};
    query.boxed = ahead;
    const Explanation box = engine->explain(query, ObjectId{3});
    EXPECT_GT(box.shown_px, 0u);
    EXPECT_GT(box.hidden_by.size(), 0u);
    query.boxed = behind;
    EXPECT_FALSE(engine->explain(query, ObjectId{3}).in_field);
  }
}

class ExplainRaster : public ::testing::TestWithParam<std::uint32_t> {};

TEST_P(ExplainRaster, NamesWhatThePlainRasterizerFindsPixelForPixel) {
  const Scene scene = testing::random_scene(GetParam(), 140);
  const auto engine = make_raster_engine(scene, with_threads(GetParam() % 3 + 1));
  std::mt19937 random(GetParam());
  std::uint64_t hidden_objects = 0;
  for (int view = 0; view < 2; ++view) {
    std::vector<Eye> eyes{testing::eye_at({0, 0, 15}, 0.0, 0.0, k_size)};
    if (view == 1) eyes = {testing::random_eye(random, k_size), testing::random_eye(random, k_size)};
    for (std::uint32_t i = 0; i < scene.object_count(); ++i) {
      const ObjectId id{i};
      const Explanation plain = plain_explanation(scene, eyes, id, k_size);
      hidden_objects += plain.alone_px > 0 && plain.shown_px == 0;
      expect_as_plain(engine->explain({eyes, k_size, {}}, id), plain, std::to_string(i) + " is the object");
    }
  }
  EXPECT_GT(hidden_objects, 0u) << "or the test shows little";
}

INSTANTIATE_TEST_SUITE_P(Seeds, ExplainRaster, ::testing::Values(1u, 2u, 3u));

TEST(ExplainRasterCases, HoldsInPicturesThatAreHardToGetRight) {
  for (const RasterCase& picture : raster_cases(11)) {
    const auto engine = make_raster_engine(picture.scene, with_threads(2));
    // Their slivers may lie anywhere, see raster_engine_test.cpp.
    if (picture.name == "slivers below a sub-pixel" || picture.name == "areas that come from snapping")
      continue;
    const std::uint32_t step = std::max(picture.scene.object_count() / 12, 1u);
    for (std::uint32_t i = 0; i < picture.scene.object_count(); i += step) {
      const Explanation plain =
          plain_explanation(picture.scene, {&picture.eye, 1}, ObjectId{i}, picture.size);
      expect_as_plain(engine->explain({{&picture.eye, 1}, picture.size, {}}, ObjectId{i}), plain,
                      picture.name + ", object " + std::to_string(i));
    }
  }
}

/// A wall before a box, both before a larger wall.
class ExplainWallAndBox : public ::testing::Test {
 protected:
  ExplainWallAndBox() {
    const auto stone = builder_.add_material(testing::opaque());
    builder_.add_wall({0, 0, -5}, 3, 3, stone);
    builder_.add_box({0, 0, -10}, {1, 1, 1}, stone);
    builder_.add_box({0, 0, 10}, {1, 1, 1}, stone);               // behind the eye
    builder_.add_wall({0, 0, -8}, 0.001, 0.001, stone);           // below a pixel
    builder_.add_box({30, 0, -10}, {0.1, 0.1, 0.1}, stone);       // beside the view
    builder_.add_wall({0, 0, -4}, 1, 1, stone, std::acos(-1.0));  // turns its back
    scene_ = builder_.finish();
    engine_ = make_raster_engine(scene_, with_threads(2));
  }
  [[nodiscard]] Explanation explain(ObjectId id, std::span<const BoxedObject> boxed = {}) {
    ViewQuery query{{&eye_, 1}, k_size, {}};
    query.boxed = boxed;
    return engine_->explain(query, id);
  }

  const ObjectId wall_{0}, box_{1}, behind_{2}, speck_{3}, beside_{4}, back_{5};
  Eye eye_ = straight_ahead();
  SceneBuilder builder_;
  Scene scene_;
  std::unique_ptr<VisibilityEngine> engine_;
};

TEST_F(ExplainWallAndBox, TheWallHidesTheBox) {
  const Explanation box = explain(box_);
  ASSERT_EQ(box.hidden_by.size(), 1u);
  EXPECT_EQ(box.hidden_by[0].id, wall_);
  EXPECT_EQ(box.hidden_by[0].pixels, box.alone_px);
  EXPECT_EQ(box.shown_px, 0u);
  const Explanation wall = explain(wall_);
  EXPECT_EQ(wall.shown_px, wall.alone_px);
  EXPECT_TRUE(wall.hidden_by.empty());
}

TEST_F(ExplainWallAndBox, WhatIsOutsideHasNoPixelAndNoBlocker) {
  for (const ObjectId id : {behind_, beside_}) {
    const Explanation outside = explain(id);
    EXPECT_TRUE(outside.known);
    EXPECT_FALSE(outside.in_field);
    EXPECT_EQ(outside.alone_px, 0u);
    EXPECT_TRUE(outside.hidden_by.empty());
  }
}

TEST_F(ExplainWallAndBox, WhatIsBelowAPixelIsLookedAtMoreClosely) {
  // Beside the middle, where no sample of the image is.
  const Explanation speck = explain(speck_);
  EXPECT_TRUE(speck.in_field);
  EXPECT_GT(speck.scale, 1u);
  if (speck.alone_px > 0) {
    ASSERT_EQ(speck.hidden_by.size(), 1u);
    EXPECT_EQ(speck.hidden_by[0].id, wall_);
  }
}

TEST_F(ExplainWallAndBox, WhatTurnsAwayIsInTheFieldAndHasNoPixel) {
  const Explanation back = explain(back_);
  EXPECT_TRUE(back.in_field);
  EXPECT_EQ(back.alone_px, 0u);
  EXPECT_TRUE(back.hidden_by.empty());
}

TEST_F(ExplainWallAndBox, FollowsTheEditsOfTheSessionAtHand) {
  SceneEdits without_wall = edits_of(1, 1);
  without_wall.hidden = {wall_};
  engine_->apply(without_wall);
  EXPECT_EQ(explain(box_).shown_px, explain(box_).alone_px);
  engine_->apply(edits_of(2, 0));
  EXPECT_EQ(explain(box_).shown_px, 0u);
  glm::dmat4x3 aside(1.0);
  aside[3] = {100.0, 0.0, -5.0};
  SceneEdits moved = edits_of(1, 2);
  moved.moves = {{wall_, aside}};
  engine_->apply(moved);
  EXPECT_EQ(explain(box_).shown_px, explain(box_).alone_px);
}

TEST_F(ExplainWallAndBox, WhatMovesHidesNothingAndIsExplainedByItsBox) {
  const std::vector<BoxedObject> wall_moves{{wall_, {{-2, -2, -6}, {2, 2, -4}}}};
  EXPECT_EQ(explain(box_, wall_moves).shown_px, explain(box_, wall_moves).alone_px);
  EXPECT_EQ(explain(wall_, wall_moves).shown_px, explain(wall_, wall_moves).alone_px);

  const std::vector<BoxedObject> box_moves{{box_, {{-0.5, -0.5, -11}, {0.5, 0.5, -9}}}};
  const Explanation hidden = explain(box_, box_moves);
  EXPECT_EQ(hidden.shown_px, 0u);
  ASSERT_EQ(hidden.hidden_by.size(), 1u);
  EXPECT_EQ(hidden.hidden_by[0].id, wall_);
  const std::vector<BoxedObject> half_out{{box_, {{-0.5, -0.5, -11}, {9.0, 0.5, -9}}}};
  EXPECT_GT(explain(box_, half_out).shown_px, 0u);
  const std::vector<BoxedObject> far_out{{box_, {{-0.5, -0.5, 9}, {0.5, 0.5, 11}}}};
  EXPECT_FALSE(explain(box_, far_out).in_field);
}

TEST_F(ExplainWallAndBox, LaterCountsAreWhatTheyWouldHaveBeen) {
  PixelCounts before, after;
  const ViewQuery query{{&eye_, 1}, k_size, {}};
  engine_ = make_raster_engine(scene_, with_threads(1));  // strips move with the time they took
  engine_->apply(edits_of(7, 0));
  (void)engine_->count(query, before);
  const EngineStats settled = engine_->count(query, before);
  for (std::uint32_t i = 0; i < scene_.object_count(); ++i) (void)explain(ObjectId{i});
  const EngineStats again = engine_->count(query, after);
  EXPECT_TRUE(before == after);
  EXPECT_EQ(again.drawn_triangles, settled.drawn_triangles) << "what the session saw last is still known";
}

TEST(ExplainRaster, OutlivesMatricesOfAnyMaking) {
  const Scene scene = testing::random_scene(4, 30);
  const auto engine = make_raster_engine(scene, with_threads(2));
  for (const double value : {0.0, 1e300, -1e300, std::numeric_limits<double>::quiet_NaN()}) {
    for (int place = 0; place < 3; ++place) {
      Eye eye = straight_ahead();
      (place == 0   ? eye.clip_from_camera[0][0]
       : place == 1 ? eye.camera_from_world[3][2]
                    : eye.clip_from_camera[2][3]) = value;
      for (std::uint32_t i = 0; i < scene.object_count(); i += 5) {
        (void)engine->explain({{&eye, 1}, k_size, {}}, ObjectId{i});
      }
    }
  }
}

TEST(ExplainRaster, NamesAtMostSoManyBlockersTheLargestOnes) {
  SceneBuilder builder;
  const auto stone = builder.add_material(testing::opaque());
  const ObjectId behind = builder.add_wall({0, 0, -20}, 40, 40, stone);
  for (int i = 0; i < 100; ++i) {
    builder.add_wall({i % 10 - 4.5, i / 10 - 4.5, -9}, i < 50 ? 0.5 : 1.0, 1.0, stone);
  }
  const Scene scene = builder.finish();
  const auto engine = make_raster_engine(scene, with_threads(1));
  const Eye eye = straight_ahead();
  const Explanation explanation = engine->explain({{&eye, 1}, k_size, {}}, behind);
  EXPECT_EQ(explanation.hidden_by.size(), k_max_blockers);
  EXPECT_TRUE(std::is_sorted(explanation.hidden_by.begin(), explanation.hidden_by.end(),
                             [](const Blocker& a, const Blocker& b) { return a.pixels > b.pixels; }));
  for (int i = 0; i < 50; ++i) EXPECT_GT(index_of(explanation.hidden_by[i].id), 50u) << "the wide ones first";
}

}  // namespace
}  // namespace sightline
