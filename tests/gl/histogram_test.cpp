#include "control_view/engines/histogram.hpp"

#include <map>
#include <random>

#include <gtest/gtest.h>

namespace sightline {
namespace {

constexpr std::uint32_t k_object_count = 500;

PixelCounts counted(const HistogramKernel& kernel, std::span<const ItemCode> codes) {
  CountAccumulator sum(k_object_count);
  kernel.add(codes, sum);
  PixelCounts counts;
  sum.take(counts);
  return counts;
}

/// The plain slow version, with nothing in common with the kernels.
PixelCounts counted_by_map(std::span<const ItemCode> codes) {
  std::map<ItemCode, std::uint32_t> pixels;
  for (const ItemCode code : codes) ++pixels[code];
  PixelCounts counts;
  for (const auto& [code, count] : pixels) {
    if (code == k_background_code) continue;
    counts.ids.push_back(object_of(code));
    counts.pixels.push_back(count);
  }
  return counts;
}

std::vector<ItemCode> random_image(std::mt19937& random, std::size_t size, double mean_run) {
  std::uniform_int_distribution<ItemCode> any_code(0, k_object_count);
  std::geometric_distribution<std::size_t> run(1.0 / mean_run);
  std::vector<ItemCode> codes;
  while (codes.size() < size) codes.insert(codes.end(), 1 + run(random), any_code(random));
  codes.resize(size);
  return codes;
}

class HistogramKernels : public testing::TestWithParam<std::size_t> {};

TEST_P(HistogramKernels, AgreeWithAMapOnRunsOfEveryLength) {
  const HistogramKernel& kernel = histogram_kernels()[GetParam()];
  if (!kernel.supported) GTEST_SKIP() << kernel.name << " is not supported by this machine";
  std::mt19937 random(7);
  for (const double mean_run : {1.0, 3.0, 20.0, 300.0}) {
    for (const std::size_t size : {0, 1, 2, 63, 64, 65, 66, 127, 128, 129, 1000, 196608}) {
      const std::vector<ItemCode> codes = random_image(random, size, mean_run);
      EXPECT_EQ(counted(kernel, codes), counted_by_map(codes)) << kernel.name << ", " << size << " pixels";
    }
  }
}

TEST_P(HistogramKernels, AgreeWithAMapWhereNoiseAndRunsMeet) {
  const HistogramKernel& kernel = histogram_kernels()[GetParam()];
  if (!kernel.supported) GTEST_SKIP() << kernel.name << " is not supported by this machine";
  std::mt19937 random(8);
  for (int image = 0; image < 40; ++image) {
    std::vector<ItemCode> codes;
    for (int stretch = 0; stretch < 30; ++stretch) {
      const auto part = random_image(random, 1 + random() % 200, stretch % 2 == 0 ? 1.0 : 40.0);
      codes.insert(codes.end(), part.begin(), part.end());
    }
    EXPECT_EQ(counted(kernel, codes), counted_by_map(codes)) << kernel.name << ", image " << image;
  }
}

TEST_P(HistogramKernels, CountNothingInABackgroundImage) {
  const HistogramKernel& kernel = histogram_kernels()[GetParam()];
  if (!kernel.supported) GTEST_SKIP() << kernel.name << " is not supported by this machine";
  const std::vector<ItemCode> codes(1000, k_background_code);
  EXPECT_TRUE(counted(kernel, codes).ids.empty());
}

INSTANTIATE_TEST_SUITE_P(All, HistogramKernels, testing::Range(std::size_t{0}, histogram_kernels().size()),
                         [](const auto& kernel) {
                           return std::string(histogram_kernels()[kernel.param].name);
                         });

TEST(CountAccumulator, StartsOverAfterTake) {
  CountAccumulator sum(3);
  PixelCounts counts;
  sum.add(ObjectId{2}, 5);
  sum.add(ObjectId{0}, 1);
  sum.add(ObjectId{2}, 5);
  sum.add(ObjectId{1}, 0);  // no pixels: not an object that was seen
  sum.take(counts);
  EXPECT_EQ(counts, (PixelCounts{{ObjectId{0}, ObjectId{2}}, {1, 10}}));
  sum.add(ObjectId{2}, 1);
  sum.take(counts);
  EXPECT_EQ(counts, (PixelCounts{{ObjectId{2}}, {1}}));
}

}  // namespace
}  // namespace sightline
