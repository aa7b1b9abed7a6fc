#include "main_view/app/item_colors.hpp"

#include <cstdlib>

#include <gtest/gtest.h>

namespace sightline {
namespace {

int distance(Rgb a, Rgb b) {
  return std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b);
}

TEST(ItemColors, NeighbouringCodesLookDifferent) {
  for (ItemCode code = 1; code < 20000; ++code) {
    ASSERT_GT(distance(item_color(code), item_color(code + 1)), 60) << code;
    ASSERT_GT(distance(item_color(code), item_color(k_background_code)), 60) << code;
  }
}

TEST(ItemColors, PictureBeginsAtTheTop) {
  const std::vector<ItemCode> codes{1, 2, 3, 4, 5, 6};  // rows from the bottom
  const Image image = item_image(codes, {2, 3});
  EXPECT_EQ(image.at(0, 2), item_color(1));
  EXPECT_EQ(image.at(1, 2), item_color(2));
  EXPECT_EQ(image.at(0, 0), item_color(5));
}

}  // namespace
}  // namespace sightline
