// The judge must be able to say "wrong": what is left out is counted, pixel by pixel.

#include "main_view/app/frame_judge.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "common/gl/context.hpp"
#include "tests/common/test_scenes.hpp"

namespace sightline {
namespace {

using namespace testing;

constexpr ImageSize k_size{160, 120};

class Judged : public ::testing::Test {
 protected:
  Judged() {
    const auto stone = builder_.add_material(opaque());
    const auto pane = builder_.add_material(glass());
    back_ = builder_.add_wall({0, 0, -20}, 60, 60, stone);
    front_ = builder_.add_wall({0, 0, -10}, 2, 2, stone);
    glass_ = builder_.add_wall({3, 0, -10}, 2, 2, pane);
    hidden_ = builder_.add_box({0, 0, -25}, {1, 1, 1}, stone);
    behind_camera_ = builder_.add_box({0, 0, 10}, {1, 1, 1}, stone);
    scene_ = builder_.finish();
    gpu_scene_.emplace(scene_, false);
    judge_.emplace(scene_, *gpu_scene_, k_size);
  }

  [[nodiscard]] static Eye eye(double x_m) {
    return {camera_from_world(Pose{{x_m, 0, 0}, {1, 0, 0, 0}}), clip_from_camera(Perspective{}, 4.0 / 3.0)};
  }

  FrameVerdict verdict(const std::vector<Eye>& eyes, const std::vector<ObjectId>& drawn) {
    judge_->look(eyes);
    return judge_->judge(eyes, drawn);
  }

  SceneBuilder builder_;
  Scene scene_;
  ObjectId back_, front_, glass_, hidden_, behind_camera_;
  std::unique_ptr<gl::Context> context_ = gl::make_offscreen_context(gl::ContextKind::osmesa);
  std::optional<gl::GpuScene> gpu_scene_;
  std::optional<FrameJudge> judge_;
  const std::vector<Eye> one_eye_ = {eye(0.0)};
};

TEST_F(Judged, FindsNothingWrongWithTheExactVisibleSet) {
  const FrameVerdict v = verdict(one_eye_, {back_, front_, glass_});
  EXPECT_EQ(v.wrong_pixels, 0u);
  EXPECT_EQ(v.missed_objects, 0u);
  EXPECT_EQ(v.visible_objects, 3u);
  EXPECT_EQ(v.pixels, k_size.pixel_count());
  EXPECT_EQ(v.triangles_oracle, 6u);
  EXPECT_EQ(v.triangles_frustum, 18u);  // the hidden box, 12 triangles, may intersect the frustum
  EXPECT_EQ(v.triangles_all, 30u);
}

TEST_F(Judged, CountsThePixelsOfAMissingOpaqueObject) {
  // 2 m at 10 m under 60 degrees of 120 pixels: 20.8 pixels a side.
  const FrameVerdict v = verdict(one_eye_, {back_, glass_});
  EXPECT_EQ(v.missed_objects, 1u);
  EXPECT_NEAR(double(v.wrong_pixels), 20.8 * 20.8, 45.0);
}

TEST_F(Judged, CountsThePixelsOfAMissingBlendedObject) {
  const FrameVerdict v = verdict(one_eye_, {back_, front_});
  EXPECT_EQ(v.missed_objects, 1u);
  EXPECT_NEAR(double(v.wrong_pixels), 20.8 * 20.8, 45.0);
}

TEST_F(Judged, CountsEveryPixelWhenNothingIsDrawn) {
  const FrameVerdict v = verdict(one_eye_, {});
  EXPECT_EQ(v.wrong_pixels, k_size.pixel_count());
  EXPECT_EQ(v.missed_objects, 3u);
}

TEST_F(Judged, DoesNotCountAHiddenObjectThatIsMissing) {
  EXPECT_EQ(verdict(one_eye_, {back_, front_, glass_, hidden_}).wrong_pixels, 0u);
  EXPECT_EQ(verdict(one_eye_, {back_, front_, glass_}).missed_objects, 0u);
}

TEST_F(Judged, LooksThroughTheSecondEyeToo) {
  // From far to the left only the second eye sees the small walls.
  const std::vector<Eye> eyes = {eye(-25.0), eye(0.0)};
  const FrameVerdict v = verdict(eyes, {back_, glass_});
  EXPECT_EQ(v.pixels, 2 * k_size.pixel_count());
  EXPECT_NEAR(double(v.wrong_pixels), 20.8 * 20.8, 45.0);
}

TEST_F(Judged, DrawsEverythingToTheSamePicture) {
  const FrameTruth quick = judge_->look(one_eye_);
  const FrameTruth thorough = judge_->look(one_eye_, FrameJudge::Thoroughness::everything);
  EXPECT_EQ(thorough.visible, quick.visible);
  EXPECT_EQ(judge_->judge(one_eye_, quick.visible).wrong_pixels, 0u);
  EXPECT_FALSE(std::binary_search(quick.in_frustum.begin(), quick.in_frustum.end(), behind_camera_));
}

TEST_F(Judged, SaysTheSameOfATruthThatItRecalls) {
  const std::vector<Eye> eyes = {eye(0.0), eye(0.5)};
  const std::vector<std::vector<ObjectId>> lists = {{},
                                                    {back_},
                                                    {back_, front_},
                                                    {back_, glass_},
                                                    {front_, glass_, hidden_},
                                                    {back_, front_, glass_, hidden_}};
  for (const std::vector<ObjectId>& drawn : lists) {
    const std::vector<ObjectId> visible = judge_->look(eyes, FrameJudge::Thoroughness::everything).visible;
    const FrameVerdict looked = judge_->judge(eyes, drawn);
    const std::vector<ObjectId> in_frustum = judge_->look(eyes).in_frustum;
    const FrameVerdict in_view = judge_->judge(eyes, drawn);
    EXPECT_EQ(judge_->recall(eyes, visible).in_frustum, in_frustum);
    const FrameVerdict recalled = judge_->judge(eyes, drawn);
    for (const FrameVerdict& v : {in_view, recalled}) {
      EXPECT_EQ(v.wrong_pixels, looked.wrong_pixels) << drawn.size();
      EXPECT_EQ(v.pixels, looked.pixels);
      EXPECT_EQ(v.missed_objects, looked.missed_objects);
      EXPECT_EQ(v.visible_objects, looked.visible_objects);
      EXPECT_EQ(v.triangles_frustum, looked.triangles_frustum);
      EXPECT_EQ(v.triangles_oracle, looked.triangles_oracle);
    }
  }
}

}  // namespace
}  // namespace sightline
