#include "control_view/engines/depth_hierarchy.hpp"

#include <random>

#include <gtest/gtest.h>

namespace sightline {
namespace {

bool any_pixel_as_far(const std::vector<float>& depth, ImageSize size, const ScreenBox& box) {
  for (std::uint32_t y = box.bottom; y < box.top; ++y) {
    for (std::uint32_t x = box.left; x < box.right; ++x) {
      if (depth[std::size_t{y} * size.width + x] <= box.nearest_depth) return true;
    }
  }
  return false;
}

/// Walls of one depth each with a few pixels left open, so that tiles differ in what they hide.
std::vector<float> random_depth(std::mt19937& random, ImageSize size) {
  std::uniform_real_distribution<float> any_depth(0.1f, 1.0f);
  std::uniform_int_distribution<std::uint32_t> pick(0, 1u << 30);
  std::vector<float> depth(size.pixel_count(), 0.05f);
  for (int wall = 0; wall < 6; ++wall) {
    const std::uint32_t left = pick(random) % size.width, bottom = pick(random) % size.height;
    const float at = any_depth(random);
    for (std::uint32_t y = bottom; y < size.height; ++y) {
      for (std::uint32_t x = left; x < size.width; ++x) {
        float& pixel = depth[std::size_t{y} * size.width + x];
        pixel = std::max(pixel, at);
      }
    }
  }
  for (int hole = 0; hole < 4; ++hole) depth[pick(random) % depth.size()] = 0.0f;
  return depth;
}

ScreenBox random_box(std::mt19937& random, ImageSize size, const std::vector<float>& depth) {
  std::uniform_int_distribution<std::uint32_t> pick(0, 1u << 30);
  ScreenBox box;
  box.left = pick(random) % size.width;
  box.bottom = pick(random) % size.height;
  box.right = box.left + 1 + pick(random) % (size.width - box.left);
  box.top = box.bottom + 1 + pick(random) % (size.height - box.bottom);
  // Depths that occur are where a tie is decided.
  box.nearest_depth = depth[pick(random) % depth.size()] * (pick(random) % 2 == 0 ? 1.0f : 0.999f);
  return box;
}

TEST(DepthHierarchy, AnswersLikeALookAtEveryPixel) {
  std::mt19937 random(1);
  DepthHierarchy hierarchy;
  std::size_t shown = 0, hidden = 0;
  for (const ImageSize size :
       {ImageSize{1, 1}, {7, 3}, {8, 8}, {9, 64}, {65, 63}, {160, 120}, {513, 70}, {64, 1}}) {
    for (int image = 0; image < 6; ++image) {
      const std::vector<float> depth = random_depth(random, size);
      hierarchy.build(depth, size);
      for (int i = 0; i < 300; ++i) {
        const ScreenBox box = random_box(random, size, depth);
        const bool expected = any_pixel_as_far(depth, size, box);
        ASSERT_EQ(hierarchy.may_show(box), expected) << size.width << "x" << size.height;
        ++(expected ? shown : hidden);
      }
    }
  }
  EXPECT_GT(shown, 2000u);
  EXPECT_GT(hidden, 2000u);
}

TEST(DepthHierarchy, LetsATieShow) {
  const std::vector<float> wall(100 * 100, 0.25f);
  DepthHierarchy hierarchy;
  hierarchy.build(wall, {100, 100});
  EXPECT_TRUE(hierarchy.may_show({10, 10, 90, 90, 0.25f}));
  EXPECT_FALSE(hierarchy.may_show({10, 10, 90, 90, std::nextafter(0.25f, 0.0f)}));
}

TEST(DepthHierarchy, AnEmptyImageHidesNothing) {
  const std::vector<float> nothing(64 * 64, 0.0f);
  DepthHierarchy hierarchy;
  hierarchy.build(nothing, {64, 64});
  EXPECT_TRUE(hierarchy.may_show({0, 0, 64, 64, 0.0f}));
}

}  // namespace
}  // namespace sightline
