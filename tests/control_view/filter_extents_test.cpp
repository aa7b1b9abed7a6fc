#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "control_view/low_pass_filter.hpp"

namespace sightline {
namespace {

constexpr std::uint32_t k_objects = 60;

struct Answer {
  PixelCounts counts;
  glm::dvec3 eye_m{0.0};
};

DirectionExtent random_extent(std::mt19937& random) {
  const auto below = [&](std::uint32_t count) { return static_cast<std::uint8_t>(random() % count); };
  const auto first = below(256), low = below(200);
  return {first, static_cast<std::uint8_t>(first + below(30)), low,
          static_cast<std::uint8_t>(low + below(40)), static_cast<std::uint8_t>(60 + below(100))};
}

Answer random_answer(std::mt19937& random, bool says_where) {
  Answer answer;
  for (std::uint32_t id = 0; id < k_objects; ++id) {
    if (random() % 3 == 0) continue;
    answer.counts.ids.push_back(ObjectId{id});
    answer.counts.pixels.push_back(1 + random() % 100);
    if (says_where) answer.counts.extents.push_back(random_extent(random));
  }
  std::uniform_real_distribution<double> way(-0.2, 0.2);
  answer.eye_m = {way(random), way(random), way(random)};
  return answer;
}

std::vector<ObjectId> some_ids(std::mt19937& random) {
  std::vector<ObjectId> ids;
  for (std::uint32_t id = 0; id < k_objects; ++id) {
    if (random() % 4 != 0) ids.push_back(ObjectId{id});
  }
  return ids;
}

/// What the plain way says, one object after the other.
DirectionExtent plain_extent(const std::deque<Answer>& answers, ObjectId id, const glm::dvec3& eye_m) {
  std::optional<DirectionExtent> sum;
  for (const Answer& answer : answers) {
    const auto& ids = answer.counts.ids;
    const auto at = std::find(ids.begin(), ids.end(), id);
    if (at == ids.end()) continue;
    if (answer.counts.extents.empty()) return k_seen_anywhere;
    const DirectionExtent seen = seen_from_nearby(
        answer.counts.extents[static_cast<std::size_t>(at - ids.begin())], glm::length(answer.eye_m - eye_m));
    sum = sum ? united(*sum, seen) : seen;
  }
  return sum.value_or(k_seen_anywhere);
}

TEST(LowPassFilterExtents, HoldWhatEachAnswerSawAndNoMoreThanAllOfThem) {
  std::mt19937 random(1);
  int narrow = 0;
  for (const std::uint32_t length : {1u, 2u, 5u}) {
    LowPassFilter filter(length);
    std::deque<Answer> answers;
    for (int round = 0; round < 60; ++round) {
      if (random() % 20 == 0) {
        filter.reset();
        answers.clear();
      }
      answers.push_back(random_answer(random, random() % 12 != 0));
      filter.add(answers.back().counts, answers.back().eye_m);
      if (answers.size() > length) answers.pop_front();

      const std::vector<ObjectId> ids = some_ids(random);
      std::vector<DirectionExtent> extents{k_seen_anywhere};  // replaced
      filter.extents_of(ids, answers.back().eye_m, extents);
      ASSERT_EQ(extents.size(), ids.size());
      for (std::size_t i = 0; i < ids.size(); ++i) {
        const DirectionExtent expected = plain_extent(answers, ids[i], answers.back().eye_m);
        // In which order they are united may choose between two ways round that are as short.
        for (const Answer& answer : answers) {
          const auto& seen = answer.counts.ids;
          const auto at = std::find(seen.begin(), seen.end(), ids[i]);
          if (at == seen.end()) continue;
          const DirectionExtent one =
              answer.counts.extents.empty()
                  ? k_seen_anywhere
                  : seen_from_nearby(answer.counts.extents[static_cast<std::size_t>(at - seen.begin())],
                                     glm::length(answer.eye_m - answers.back().eye_m));
          ASSERT_TRUE(holds(extents[i], one));
        }
        ASSERT_EQ(extents[i].elevation_first, expected.elevation_first);
        ASSERT_EQ(extents[i].elevation_last, expected.elevation_last);
        ASSERT_EQ(extents[i].distance, expected.distance);
        if (length < 3) {
          ASSERT_EQ((extents[i].azimuth_last - extents[i].azimuth_first) & 255,
                    (expected.azimuth_last - expected.azimuth_first) & 255);
        }
        narrow += extents[i] != k_seen_anywhere ? 1 : 0;
      }
    }
  }
  EXPECT_GT(narrow, 1000);
}

TEST(LowPassFilterExtents, AreAnywhereForWhatNoAnswerSaw) {
  LowPassFilter filter(4);
  std::vector<DirectionExtent> extents;
  filter.extents_of(std::vector{ObjectId{1}, ObjectId{2}}, {}, extents);
  EXPECT_EQ(extents, (std::vector{k_seen_anywhere, k_seen_anywhere}));
  PixelCounts counts;
  counts.ids = {ObjectId{2}};
  counts.pixels = {5};
  counts.extents = {{1, 2, 3, 4, 100}};
  filter.add(counts);
  filter.extents_of(std::vector{ObjectId{1}, ObjectId{2}}, {}, extents);
  EXPECT_EQ(extents, (std::vector{k_seen_anywhere, counts.extents[0]}));
  filter.extents_of({}, {}, extents);
  EXPECT_TRUE(extents.empty());
}

TEST(LowPassFilterExtents, AreForgottenWithTheirAnswer) {
  LowPassFilter filter(2);
  PixelCounts counts;
  counts.ids = {ObjectId{7}};
  counts.pixels = {5};
  const auto extent_after = [&](const DirectionExtent& extent) {
    counts.extents = {extent};
    filter.add(counts);
    std::vector<DirectionExtent> extents;
    filter.extents_of(counts.ids, {}, extents);
    return extents[0];
  };
  EXPECT_EQ(extent_after({10, 12, 100, 110, 80}), (DirectionExtent{10, 12, 100, 110, 80}));
  EXPECT_EQ(extent_after({20, 22, 100, 110, 70}), (DirectionExtent{10, 22, 100, 110, 70}));
  EXPECT_EQ(extent_after({20, 22, 105, 110, 90}), (DirectionExtent{20, 22, 100, 110, 70}));
  EXPECT_EQ(extent_after({20, 22, 105, 110, 90}), (DirectionExtent{20, 22, 105, 110, 90}));
}

TEST(LowPassFilterExtents, TurnWithTheWayOfTheEye) {
  LowPassFilter filter(4);
  PixelCounts counts;
  counts.ids = {ObjectId{7}};
  counts.pixels = {5};
  counts.extents = {{10, 12, 126, 129, 80}};
  const double near_m = distance_m(counts.extents[0]);
  filter.add(counts, {1.0, 2.0, 3.0});
  std::vector<DirectionExtent> extents;
  filter.extents_of(counts.ids, {1.0, 2.0, 3.0}, extents);
  EXPECT_EQ(extents[0], counts.extents[0]);
  filter.extents_of(counts.ids, {1.0 + 0.1 * near_m, 2.0, 3.0}, extents);
  EXPECT_EQ(extents[0], seen_from_nearby(counts.extents[0], 0.1 * near_m));
  EXPECT_NE(extents[0], counts.extents[0]);
  filter.extents_of(counts.ids, {1.0, 2.0, 3.0 + 2.0 * near_m}, extents);
  EXPECT_EQ(extents[0], k_seen_anywhere);
}

}  // namespace
}  // namespace sightline
