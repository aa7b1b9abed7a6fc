#include "control_view/low_pass_filter.hpp"

#include <deque>
#include <random>

#include <gtest/gtest.h>

#include "control_view/threshold.hpp"

namespace sightline {
namespace {

constexpr std::uint32_t k_objects = 300;

PixelCounts random_counts(std::mt19937& random, std::uint32_t one_in) {
  PixelCounts counts;
  for (std::uint32_t id = 0; id < k_objects; ++id) {
    if (random() % one_in != 0) continue;
    counts.ids.push_back(ObjectId{id});
    counts.pixels.push_back(1 + random() % 1000);
  }
  return counts;
}

PixelCounts counts_of(std::vector<std::pair<std::uint32_t, std::uint32_t>> entries) {
  PixelCounts counts;
  for (const auto& [id, pixels] : entries) {
    counts.ids.push_back(ObjectId{id});
    counts.pixels.push_back(pixels);
  }
  return counts;
}

/// The plain version: one slot for every object there is.
class DenseFilter {
 public:
  explicit DenseFilter(std::size_t length) : length_(length) {}
  void add(const PixelCounts& counts) {
    std::vector<double> pixels(k_objects, 0.0);
    for (std::size_t i = 0; i < counts.ids.size(); ++i) pixels[index_of(counts.ids[i])] = counts.pixels[i];
    answers_.push_back(std::move(pixels));
    if (answers_.size() > length_) answers_.pop_front();
  }
  void reset() { answers_.clear(); }
  [[nodiscard]] double mean(std::uint32_t id) const {
    double sum = 0.0;
    for (const auto& answer : answers_) sum += answer[id];
    return answers_.empty() ? 0.0 : sum / static_cast<double>(answers_.size());
  }

 private:
  std::size_t length_;
  std::deque<std::vector<double>> answers_;
};

TEST(LowPassFilter, EqualsTheDenseFilterOnRandomAnswers) {
  std::mt19937 random(20240607);
  for (const std::uint32_t length : {1u, 2u, 3u, 8u, 17u}) {
    LowPassFilter filter(length);
    DenseFilter dense(length);
    for (int answer = 0; answer < 200; ++answer) {
      if (random() % 40 == 0) {
        filter.reset();
        dense.reset();
      }
      const PixelCounts counts = random_counts(random, 1 + random() % 30);
      filter.add(counts);
      dense.add(counts);

      const MeanPixels means = filter.means();
      std::size_t at = 0;
      for (std::uint32_t id = 0; id < k_objects; ++id) {
        const double expected = dense.mean(id);
        const bool held = at < means.ids.size() && means.ids[at] == ObjectId{id};
        ASSERT_EQ(held, expected > 0.0) << "length " << length << ", object " << id;
        if (!held) continue;
        ASSERT_NEAR(means.mean(at++), expected, 1e-9);
      }
      ASSERT_EQ(at, means.ids.size());
    }
  }
}

TEST(LowPassFilter, HoldsAnObjectForExactlyItsLength) {
  LowPassFilter filter(3);
  filter.add(counts_of({{7, 1}}));
  filter.add({});
  filter.add({});
  EXPECT_EQ(filter.means().ids.size(), 1u);
  filter.add({});
  EXPECT_TRUE(filter.means().ids.empty());
}

TEST(LowPassFilter, AveragesOverTheAnswersThereAre) {
  LowPassFilter filter(8);
  filter.add(counts_of({{1, 10}}));
  EXPECT_DOUBLE_EQ(filter.means().mean(0), 10.0);
  filter.add(counts_of({{1, 20}}));
  EXPECT_DOUBLE_EQ(filter.means().mean(0), 15.0);
}

TEST(LowPassFilter, DoesNotOverflowOnTheLargestCounts) {
  LowPassFilter filter(4);
  for (int i = 0; i < 4; ++i) filter.add(counts_of({{0, 0xffffffffu}}));
  EXPECT_DOUBLE_EQ(filter.means().mean(0), 4294967295.0);
}

TEST(LowPassFilter, ForgetsEverythingOnReset) {
  LowPassFilter filter(4);
  filter.add(counts_of({{0, 5}, {9, 5}}));
  filter.reset();
  EXPECT_TRUE(filter.means().ids.empty());
  EXPECT_EQ(filter.answer_count(), 0u);
}

TEST(Threshold, AtZeroKeepsWhateverHasAPixel) {
  LowPassFilter filter(8);
  filter.add(counts_of({{3, 1}}));
  for (int i = 0; i < 7; ++i) filter.add({});
  std::vector<ObjectId> scratch;
  EXPECT_EQ(visible_above(filter.means(), 0.0, scratch).to_ids(), std::vector{ObjectId{3}});
}

TEST(Threshold, KeepsOnlyMeansAboveIt) {
  LowPassFilter filter(2);
  filter.add(counts_of({{1, 4}, {2, 2}, {3, 5}}));
  filter.add(counts_of({{1, 4}, {3, 4}}));
  std::vector<ObjectId> scratch;
  EXPECT_EQ(visible_above(filter.means(), 4.0, scratch).to_ids(), std::vector{ObjectId{3}});
}

}  // namespace
}  // namespace sightline
