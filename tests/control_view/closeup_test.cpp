#include "control_view/engines/raster/closeup.hpp"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

namespace sightline::raster {
namespace {

/// Blocks of a view, as one flag each.
class BlockGrid {
 public:
  BlockGrid(std::int32_t width, std::int32_t height)
      : width_(width), times_(static_cast<std::size_t>(width * height), 0) {}
  int& at(std::int32_t x, std::int32_t y) { return times_.at(static_cast<std::size_t>(y * width_ + x)); }
  [[nodiscard]] std::size_t taken() const {
    return times_.size() - static_cast<std::size_t>(std::count(times_.begin(), times_.end(), 0));
  }

 private:
  std::int32_t width_;
  std::vector<int> times_;
};

/// Of the view, without the rim.
OpenSpot blocks_of(const Closeup& closeup) {
  const std::int32_t fine_block = k_block * k_closeup_scale;
  OpenSpot blocks;
  blocks.left = (closeup.region.x + k_block) / fine_block;
  blocks.bottom = (closeup.region.y + k_block) / fine_block;
  blocks.right = blocks.left + (closeup.region.width - 2 * k_block) / fine_block - 1;
  blocks.top = blocks.bottom + (closeup.region.height - 2 * k_block) / fine_block - 1;
  return blocks;
}

bool cross(const OpenSpot& a, const OpenSpot& b) {
  return a.left <= b.right && b.left <= a.right && a.bottom <= b.top && b.bottom <= a.top;
}

void expect_right(const std::vector<OpenSpot>& spots, std::int32_t width, std::int32_t height) {
  std::vector<std::uint32_t> uncovered;
  const std::vector<Closeup> closeups = closeups_of(spots, width, height, uncovered);
  BlockGrid looked_at(width, height);
  for (const Closeup& closeup : closeups) {
    const OpenSpot blocks = blocks_of(closeup);
    ASSERT_EQ(closeup.region.x, blocks.left * k_block * k_closeup_scale - k_block);
    ASSERT_EQ(closeup.region.y, blocks.bottom * k_block * k_closeup_scale - k_block);
    ASSERT_EQ((closeup.region.width - 2 * k_block) % (k_block * k_closeup_scale), 0);
    ASSERT_LE(closeup.region.width, static_cast<std::int32_t>(k_longest_closeup_px));
    ASSERT_LE(closeup.region.height, static_cast<std::int32_t>(k_highest_closeup_px));
    ASSERT_EQ(blocks.bottom, blocks.top);
    ASSERT_GE(blocks.right, blocks.left);
    for (std::int32_t x = blocks.left; x <= blocks.right; ++x) ++looked_at.at(x, blocks.bottom);
  }
  ASSERT_LE(looked_at.taken(), k_most_closeup_blocks);
  for (std::int32_t y = 0; y < height; ++y) {
    for (std::int32_t x = 0; x < width; ++x) ASSERT_LE(looked_at.at(x, y), 1) << "looked at twice";
  }
  BlockGrid wanted(width, height);
  std::size_t left_out = 0;
  for (const OpenSpot& spot : spots) {
    if (std::find(uncovered.begin(), uncovered.end(), spot.object) != uncovered.end()) {
      ++left_out;
      continue;
    }
    for (std::int32_t y = spot.bottom; y <= spot.top; ++y) {
      for (std::int32_t x = spot.left; x <= spot.right; ++x) {
        wanted.at(x, y) = 1;
        ASSERT_EQ(looked_at.at(x, y), 1) << "object " << spot.object;
      }
    }
    for (const Closeup& closeup : closeups) {
      const auto& asked = closeup.candidates;
      ASSERT_EQ(std::count(asked.begin(), asked.end(), spot.object), cross(spot, blocks_of(closeup)) ? 1 : 0);
    }
  }
  ASSERT_EQ(left_out, uncovered.size());
  // Nothing for nobody.
  ASSERT_EQ(wanted.taken(), looked_at.taken());
}

TEST(Closeups, CoverEverySpotOrSayThatTheyDoNot) {
  std::mt19937 random(1);
  const auto below = [&](std::int32_t count) {
    return static_cast<std::int32_t>(random() % static_cast<std::uint32_t>(count));
  };
  for (int round = 0; round < 400; ++round) {
    const std::int32_t width = 1 + below(70), height = 1 + below(50);
    std::vector<OpenSpot> spots;
    for (std::uint32_t object = 0, count = static_cast<std::uint32_t>(below(200)); object < count; ++object) {
      OpenSpot spot;
      spot.object = object;
      spot.left = below(width);
      spot.bottom = below(height);
      spot.right = std::min(width - 1, spot.left + below(4));
      spot.top = std::min(height - 1, spot.bottom + below(3));
      spots.push_back(spot);
    }
    expect_right(spots, width, height);
  }
}

TEST(Closeups, TakeNoMoreBlocksThanAllowedAndShareThem) {
  std::vector<OpenSpot> spots;
  for (std::uint32_t object = 0; object < 1000; ++object) {
    const auto at = static_cast<std::int32_t>(object % 500);
    spots.push_back({object, at % 50, at / 50, at % 50, at / 50});
  }
  std::vector<std::uint32_t> uncovered;
  (void)closeups_of(spots, 50, 10, uncovered);
  // The second object of a block costs nothing.
  EXPECT_EQ(uncovered.size(), 1000 - 2 * k_most_closeup_blocks);
  expect_right(spots, 50, 10);
}

TEST(Closeups, CutLongRows) {
  const std::vector<OpenSpot> spots{{5, 0, 3, 19, 3}};
  std::vector<std::uint32_t> uncovered;
  EXPECT_EQ(closeups_of(spots, 40, 10, uncovered).size(), 3u);
  EXPECT_TRUE(uncovered.empty());
  expect_right(spots, 40, 10);
}

TEST(Closeups, OfNothingAreNone) {
  std::vector<std::uint32_t> uncovered;
  EXPECT_TRUE(closeups_of({}, 40, 10, uncovered).empty());
  EXPECT_TRUE(uncovered.empty());
}

}  // namespace
}  // namespace sightline::raster
