#include "control_view/still_view_refiner.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "control_view/visibility_pipeline.hpp"
#include "tests/control_view/fake_engine.hpp"

namespace sightline {
namespace {

using test::eye_at;
using test::FakeEngine;
using test::ids_of;
using test::seed_of;
using Refine = StillViewRefiner::Look;

constexpr ImageSize k_control{100, 80};

ViewRequest request_from(double place, ImageSize main_size = {250, 100}) {
  ViewRequest request;
  request.eyes = {eye_at(place)};
  request.main_size = main_size;
  return request;
}

PipelineOptions options(std::uint32_t filter_length = 8) {
  return {k_control, filter_length, 0.0, true};
}

double zero_clock() {
  return 0.0;
}

/// What all tiles of a view show together.
VisibleSet all_tiles(double place, ImageSize main_size) {
  VisibleSet seen;
  for (std::uint32_t y = 0; y < main_size.height; y += k_control.height) {
    for (std::uint32_t x = 0; x < main_size.width; x += k_control.width) {
      seen.unite(VisibleSet(ids_of(seed_of(place, ImageWindow{main_size, x, y}))));
    }
  }
  return seen;
}

VisibleSet whole_view(double place) {
  return VisibleSet(ids_of(seed_of(place, {})));
}

TEST(StillViewRefiner, CoversEveryPixelOfTheMainImageOnce) {
  for (const ImageSize main_size : {ImageSize{250, 100}, {200, 160}, {101, 81}, {40, 30}, {1, 1000}}) {
    StillViewRefiner refiner(k_control);
    refiner.begin(request_from(1.0, main_size), 0);
    refiner.add_whole_view({}, 0.0);
    std::vector<int> looks(main_size.pixel_count(), 0);
    while (refiner.next_look(0.0) == Refine::tile) {
      const auto tile = refiner.tile();
      ASSERT_EQ(tile.window.image, main_size);
      ASSERT_LE(tile.size.width, k_control.width);
      ASSERT_LE(tile.size.height, k_control.height);
      for (std::uint32_t y = 0; y < tile.size.height; ++y) {
        for (std::uint32_t x = 0; x < tile.size.width; ++x) {
          ++looks.at(std::size_t{tile.window.y + y} * main_size.width + tile.window.x + x);
        }
      }
      refiner.add_tile({});
    }
    EXPECT_TRUE(refiner.complete());
    EXPECT_TRUE(std::all_of(looks.begin(), looks.end(), [](int times) { return times == 1; }));
  }
}

TEST(StillViewRefiner, HasNothingToRefineWhereTheWholeViewIsTheMainImage) {
  StillViewRefiner refiner(k_control);
  refiner.begin(request_from(1.0, k_control), 0);
  refiner.add_whole_view({}, 0.0);
  EXPECT_EQ(refiner.next_look(0.0), Refine::whole_view);
}

TEST(StillViewRefiner, LooksAgainWithoutTheGuardBandAtEqualSize) {
  StillViewRefiner refiner(k_control);
  refiner.begin(request_from(1.0, k_control), 0);
  refiner.add_whole_view({}, 0.1);
  EXPECT_EQ(refiner.next_look(0.1), Refine::tile);
  EXPECT_EQ(refiner.tile_count(), 1u);
}

TEST(StillViewRefiner, DrawsWholeViewsForAClientThatDoesNotSayItsSize) {
  StillViewRefiner refiner(k_control);
  refiner.begin(request_from(1.0, {0, 0}), 0);
  refiner.add_whole_view({}, 0.1);
  EXPECT_EQ(refiner.next_look(0.1), Refine::whole_view);
  EXPECT_FALSE(refiner.complete());
}

TEST(StillViewRefiner, SweepsNoImageLargerThanItsLimit) {
  StillViewRefiner refiner(k_control);
  refiner.begin(request_from(1.0, {3840, 2160}), 0);
  refiner.add_whole_view({}, 0.0);
  EXPECT_EQ(refiner.next_look(0.0), Refine::tile);
  for (const ImageSize huge : {ImageSize{3841, 2160}, {k_max_image_side, k_max_image_side}}) {
    refiner.begin(request_from(1.0, huge), 0);
    refiner.add_whole_view({}, 0.0);
    EXPECT_EQ(refiner.next_look(0.0), Refine::whole_view);
    EXPECT_FALSE(refiner.complete());
  }
}

TEST(StillViewRefiner, LooksAtTheWholeAgainWhenTheErrorGrowsAndKeepsItsTiles) {
  StillViewRefiner refiner(k_control);
  refiner.begin(request_from(1.0), 0);
  refiner.add_whole_view({}, 0.1);
  refiner.add_tile({});
  EXPECT_EQ(refiner.next_look(0.2), Refine::whole_view);
  refiner.add_whole_view({}, 0.2);
  EXPECT_EQ(refiner.next_look(0.15), Refine::tile);
  EXPECT_EQ(refiner.tile().window.x, k_control.width);
}

TEST(StillViewRefiner, StartsAnewWhenAnythingDiffersByABit) {
  StillViewRefiner refiner(k_control);
  const ViewRequest request = request_from(1.0);
  EXPECT_TRUE(refiner.begin(request, 0));
  EXPECT_FALSE(refiner.begin(request, 0));
  EXPECT_TRUE(refiner.begin(request, 1));
  ViewRequest moved = request;
  moved.eyes[0].camera_from_world[3][0] = std::nextafter(moved.eyes[0].camera_from_world[3][0], 10.0);
  EXPECT_TRUE(refiner.begin(moved, 1));
  moved.main_size.width += 1;
  EXPECT_TRUE(refiner.begin(moved, 1));
  moved.eyes.push_back(moved.eyes[0]);
  EXPECT_TRUE(refiner.begin(moved, 1));
}

TEST(VisibilityPipeline, IsExactOnceASweepOfAStillCameraIsComplete) {
  FakeEngine engine;
  VisibilityPipeline pipeline(options(), zero_clock);
  const ViewRequest request = request_from(3.0);
  VisibleSet expected = whole_view(3.0);
  EXPECT_EQ(pipeline.look(request, {}, engine).visible, expected);
  VisibleSet last;
  for (int look = 0; look < 6; ++look) last = pipeline.look(request, {}, engine).visible;
  EXPECT_EQ(last, all_tiles(3.0, request.main_size));
  EXPECT_EQ(engine.count_calls, 7);

  const Look cheap = pipeline.look(request, {}, engine);
  EXPECT_EQ(cheap.visible, last);
  EXPECT_EQ(cheap.drawn_objects, 0u);
  EXPECT_EQ(engine.count_calls, 7) << "a complete sweep needs no more drawing";
}

TEST(VisibilityPipeline, OnlyAddsToTheSetWhileItSweeps) {
  FakeEngine engine;
  VisibilityPipeline pipeline(options(), zero_clock);
  const ViewRequest request = request_from(3.0);
  VisibleSet before = pipeline.look(request, {}, engine).visible;
  for (int look = 0; look < 5; ++look) {
    VisibleSet now = pipeline.look(request, {}, engine).visible;
    VisibleSet both = before;
    both.unite(now);
    EXPECT_EQ(both, now);
    before = now;
  }
}

TEST(VisibilityPipeline, KeepsTheGuardBandOfAStillCameraThatMayTurn) {
  FakeEngine engine;
  VisibilityPipeline pipeline(options(), zero_clock);
  ViewRequest request = request_from(3.0);
  request.rotation_error_rad = 0.1;
  VisibleSet last;
  for (int look = 0; look < 8; ++look) last = pipeline.look(request, {}, engine).visible;
  VisibleSet expected = all_tiles(3.0, request.main_size);
  expected.unite(whole_view(3.0));
  EXPECT_EQ(last, expected);
}

TEST(VisibilityPipeline, WidensWholeViewsAndNeverTiles) {
  FakeEngine engine;
  VisibilityPipeline pipeline(options(), zero_clock);
  ViewRequest request = request_from(3.0);
  request.rotation_error_rad = 0.1;
  (void)pipeline.look(request, {}, engine);
  // As wide as the error asks for, with as many pixels a degree, and nothing as near as the client's own near
  // plane may cut away.
  glm::dmat4 wide = widened(request.eyes[0].clip_from_camera, 0.1);
  move_near_plane(wide, near_reach_m(request.eyes[0].clip_from_camera));
  EXPECT_EQ(engine.last_eyes.at(0).clip_from_camera, wide);
  EXPECT_GT(engine.sizes.back().width, k_control.width);
  EXPECT_GE(engine.sizes.back().width * wide[0][0], k_control.width * request.eyes[0].clip_from_camera[0][0]);
  EXPECT_GE(engine.sizes.back().height * wide[1][1],
            k_control.height * request.eyes[0].clip_from_camera[1][1]);
  (void)pipeline.look(request, {}, engine);
  EXPECT_TRUE(engine.windows.back().has_value());
  EXPECT_EQ(engine.last_eyes, request.eyes);
}

TEST(VisibilityPipeline, KeepsWhatASweepFoundWhenTheCameraStarts) {
  FakeEngine engine;
  VisibilityPipeline pipeline(options(), zero_clock);
  const ViewRequest still = request_from(3.0);
  VisibleSet found;
  for (int look = 0; look < 8; ++look) found = pipeline.look(still, {}, engine).visible;

  VisibleSet expected = found;
  expected.unite(whole_view(3.0));
  expected.unite(whole_view(4.0));
  EXPECT_EQ(pipeline.look(request_from(4.0), {}, engine).visible, expected);

  VisibleSet last;
  VisibleSet recent;
  for (double place = 5.0; place <= 12.0; ++place) {
    last = pipeline.look(request_from(place), {}, engine).visible;
    recent.unite(whole_view(place));
  }
  EXPECT_EQ(last, recent) << "the filter forgets them like any other answer";
}

TEST(VisibilityPipeline, LooksAtTheWholeAgainWhenAnObjectMoves) {
  FakeEngine engine;
  VisibilityPipeline pipeline(options(), zero_clock);
  const ViewRequest request = request_from(3.0);
  for (int look = 0; look < 3; ++look) (void)pipeline.look(request, {}, engine);
  SceneEdits edits;
  edits.version = 1;
  edits.moves = {{ObjectId{4999}, glm::dmat4x3(1.0)}};
  EXPECT_TRUE(pipeline.look(request, edits, engine).visible.contains(ObjectId{4999}));
  EXPECT_FALSE(engine.windows.back().has_value());
}

TEST(VisibilityPipeline, LooksAtTheWholeForAsLongAsAnObjectIsOnTheMove) {
  FakeEngine engine;
  VisibilityPipeline pipeline(options(), zero_clock);
  const ViewRequest still = request_from(3.0);
  for (int look = 0; look < 8; ++look) (void)pipeline.look(still, {}, engine);
  ViewRequest moving = still;
  moving.boxed = {{ObjectId{4999}, {glm::dvec3(0.0), glm::dvec3(1.0)}}};
  for (int look = 0; look < 8; ++look) {
    moving.boxed[0].world_bounds.max.x += 1.0;
    EXPECT_TRUE(pipeline.look(moving, {}, engine).visible.contains(ObjectId{4999}));
    EXPECT_FALSE(engine.windows.back().has_value());
    EXPECT_EQ(engine.last_boxed, moving.boxed);
  }
  VisibleSet last;
  for (int look = 0; look < 8; ++look) last = pipeline.look(still, {}, engine).visible;
  EXPECT_EQ(last, all_tiles(3.0, still.main_size)) << "at rest it sweeps again";
}

TEST(VisibilityPipeline, ForgetsEverythingOnAReset) {
  FakeEngine engine;
  VisibilityPipeline pipeline(options(), zero_clock);
  for (int look = 0; look < 4; ++look) (void)pipeline.look(request_from(3.0), {}, engine);
  ViewRequest jump = request_from(9.0);
  jump.reset_filter = true;
  EXPECT_EQ(pipeline.look(jump, {}, engine).visible, whole_view(9.0));
}

TEST(VisibilityPipeline, DrawsOnlyWholeViewsWithRefinementOff) {
  FakeEngine engine;
  PipelineOptions plain = options();
  plain.refine = false;
  VisibilityPipeline pipeline(plain, zero_clock);
  for (int look = 0; look < 12; ++look) {
    EXPECT_EQ(pipeline.look(request_from(3.0), {}, engine).visible, whole_view(3.0));
  }
  for (const auto& window : engine.windows) EXPECT_FALSE(window.has_value());
}

TEST(VisibilityPipeline, UnitesTheEyesOfARequest) {
  FakeEngine engine;
  VisibilityPipeline pipeline(options(1), zero_clock);
  ViewRequest request = request_from(3.0);
  request.eyes.push_back(eye_at(5.0));
  VisibleSet expected = whole_view(3.0);
  expected.unite(whole_view(5.0));
  EXPECT_EQ(pipeline.look(request, {}, engine).visible, expected);
}

TEST(VisibilityPipeline, TakesAnyRotationErrorARequestCanState) {
  ViewRequest request = request_from(3.0);
  request.rotation_error_rad = -1.0;
  EXPECT_EQ(rotation_error_of(request), 0.0);
  for (const double wild : {1e300, double(INFINITY), double(NAN)}) {
    request.rotation_error_rad = wild;
    EXPECT_GT(rotation_error_of(request), 3.14);
    EXPECT_LT(rotation_error_of(request), 3.15);
  }
}

}  // namespace
}  // namespace sightline
