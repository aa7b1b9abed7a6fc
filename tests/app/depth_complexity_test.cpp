#include "main_view/app/depth_complexity.hpp"

#include <memory>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "common/gl/context.hpp"
#include "main_view/app/drawable_scene.hpp"
#include "main_view/app/image_set.hpp"
#include "tests/common/test_scenes.hpp"

namespace sightline {
namespace {

using testing::SceneBuilder;

constexpr ImageSize k_size{64, 48};

Eye eye_ahead() {
  return {glm::dmat4(1.0), clip_from_camera({}, double(k_size.width) / k_size.height)};
}

std::uint32_t layers_at(const LayerCounts& counts, std::uint32_t x, std::uint32_t y) {
  return counts.layers[std::size_t{y} * counts.size.width + x];
}

class DepthComplexityOf : public ::testing::Test {
 protected:
  std::unique_ptr<gl::Context> context_ = gl::make_offscreen_context(gl::ContextKind::osmesa);
};

TEST_F(DepthComplexityOf, WallsBehindOneAnotherIsTheirNumber) {
  SceneBuilder builder;
  const auto stone = builder.add_material(testing::opaque());
  // Seven walls that fill the view, and three more in its right half alone: ten layers right, seven left.
  for (int i = 0; i < 7; ++i) builder.add_wall({0, 0, -2.0 - i}, 100.0, 100.0, stone);
  for (int i = 0; i < 3; ++i) builder.add_wall({50, 0, -20.0 - i}, 100.0, 200.0, stone);
  DrawableScene scene(builder.finish());
  const LayerCounts counts = DepthComplexity(k_size).count(scene.gpu(), eye_ahead(), scene.all_ids());
  EXPECT_EQ(counts.max, 10u);
  EXPECT_DOUBLE_EQ(counts.mean, 8.5);
  for (std::uint32_t y = 0; y < k_size.height; ++y) {
    for (std::uint32_t x = 0; x < k_size.width; ++x) {
      ASSERT_EQ(layers_at(counts, x, y), x < k_size.width / 2 ? 7u : 10u) << x << "," << y;
    }
  }
}

TEST_F(DepthComplexityOf, BackFacesAndHolesAreNone) {
  SceneBuilder builder;
  builder.add_box({0, 0, -5}, {100, 100, 1}, builder.add_material(testing::opaque()));
  builder.add_wall({0, 0, -3}, 100.0, 100.0, builder.add_material(testing::glass()));
  builder.add_wall({0, 0, -2}, 100.0, 100.0, builder.add_material(testing::opaque()), 3.14159265);
  builder.add_wall({0, 0, -1}, 2.0, 2.0, builder.add_checker_mask(2));
  DrawableScene scene(builder.finish());
  const LayerCounts counts = DepthComplexity(k_size).count(scene.gpu(), eye_ahead(), scene.all_ids());
  // The box's front and the glass everywhere, its back and the averted wall nowhere; the checker where it is.
  EXPECT_EQ(layers_at(counts, 16, 12), 3u) << "upper left check";
  EXPECT_EQ(layers_at(counts, 48, 12), 2u) << "upper right hole";
  EXPECT_EQ(layers_at(counts, 16, 36), 2u) << "lower left hole";
  EXPECT_EQ(layers_at(counts, 48, 36), 3u) << "lower right check";
}

TEST_F(DepthComplexityOf, NothingIsNothing) {
  SceneBuilder builder;
  builder.add_box({0, 0, 50}, {1, 1, 1}, builder.add_material(testing::opaque()));
  DrawableScene scene(builder.finish());
  const LayerCounts counts = DepthComplexity(k_size).count(scene.gpu(), eye_ahead(), scene.all_ids());
  EXPECT_EQ(counts.max, 0u);
  EXPECT_EQ(counts.mean, 0.0);
  EXPECT_NO_THROW((void)depth_complexity_image(counts, counts.max));
}

TEST_F(DepthComplexityOf, ImageSetTellsWhatCullingSavedAndLost) {
  SceneBuilder builder;
  const auto stone = builder.add_material(testing::opaque());
  const ObjectId front = builder.add_wall({0, 0, -2}, 100.0, 100.0, stone);
  for (int i = 0; i < 5; ++i) builder.add_wall({0, 0, -3.0 - i}, 10.0, 10.0, stone);
  DrawableScene scene(builder.finish());
  const testing::TemporaryFolder folder;
  const std::vector<ObjectId> seen{front};
  const ImageSetResult right = write_image_set(folder / "right", scene, eye_ahead(), k_size, seen);
  EXPECT_EQ(right.wrong_pixels, 0u);
  EXPECT_EQ(right.depth_complexity_frustum_max, 6u);
  EXPECT_EQ(right.depth_complexity_drawn_max, 1u);
  for (const char* name : {"with_culling", "without_culling", "difference", "item_buffer", "frozen_view",
                           "depth_complexity_frustum", "depth_complexity_drawn"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "right" / (std::string(name) + ".png"))) << name;
  }
  const ImageSetResult wrong = write_image_set(folder / "wrong", scene, eye_ahead(), k_size, {});
  EXPECT_EQ(wrong.wrong_pixels, k_size.pixel_count());
}

}  // namespace
}  // namespace sightline
