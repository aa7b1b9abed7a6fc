#include "common/object_hierarchy.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <glm/ext/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>

#include "common/sort_object_ids.hpp"
#include "common/view.hpp"

namespace sightline {
namespace {

std::vector<Aabb> random_boxes(std::size_t count, std::uint64_t seed, float spread = 100.0f) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> place(-spread, spread);
  std::exponential_distribution<float> size(1.0f);
  std::vector<Aabb> boxes(count);
  for (Aabb& box : boxes) {
    box.min = {place(random), place(random), place(random)};
    box.max = box.min + glm::vec3(size(random), size(random), size(random));
  }
  return boxes;
}

Frustum random_frustum(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const glm::dquat rotation =
      glm::normalize(glm::dquat(unit(random), unit(random), unit(random), unit(random)));
  const Pose pose{80.0 * glm::dvec3(unit(random), unit(random), unit(random)), rotation};
  return frustum_of(clip_from_camera({0.9, 0.1, 60.0 + 50.0 * unit(random)}, 1.4) * camera_from_world(pose));
}

std::vector<ObjectId> plain_loop(const Frustum& frustum, std::span<const Aabb> boxes) {
  std::vector<ObjectId> ids;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (may_intersect(frustum, boxes[i])) ids.push_back(ObjectId{static_cast<std::uint32_t>(i)});
  }
  return ids;
}

TEST(ObjectHierarchy, CollectsWhatThePlainLoopKeeps) {
  std::mt19937_64 random(5);
  for (const std::size_t count : {0u, 1u, 3u, 5u, 100u, 20000u}) {
    const auto boxes = random_boxes(count, count);
    const ObjectHierarchy hierarchy(boxes);
    std::vector<ObjectId> found{ObjectId{7}};  // cleared first
    std::size_t total = 0;
    for (int i = 0; i < 100; ++i) {
      const Frustum frustum = random_frustum(random);
      hierarchy.collect_in_frustum(frustum, found);
      ASSERT_EQ(found, plain_loop(frustum, boxes));
      total += found.size();
    }
    EXPECT_TRUE(count < 100 || (total > 0 && total < 100 * count));
  }
}

TEST(ObjectHierarchy, FollowsMovedObjects) {
  std::mt19937_64 random(6);
  auto boxes = random_boxes(3000, 6);
  ObjectHierarchy hierarchy(boxes);
  std::vector<ObjectId> found;
  for (int round = 0; round < 30; ++round) {
    std::vector<ObjectId> ids;
    std::vector<Aabb> places;
    for (const Aabb& box : random_boxes(40, 100 + round)) {
      const auto index = static_cast<std::uint32_t>(random() % boxes.size());
      if (std::find(ids.begin(), ids.end(), ObjectId{index}) != ids.end()) continue;
      ids.push_back(ObjectId{index});
      places.push_back(round % 3 == 0 && index % 5 == 0 ? Aabb{} : box);  // some vanish, and come back later
      boxes[index] = places.back();
    }
    hierarchy.move(ids, places);
    const Frustum frustum = random_frustum(random);
    hierarchy.collect_in_frustum(frustum, found);
    ASSERT_EQ(found, plain_loop(frustum, boxes));
  }
}

TEST(ObjectHierarchy, NeverReportsEmptyBoxesAndShowsThemOnceFilled) {
  std::vector<Aabb> boxes(100);
  for (std::uint32_t i = 0; i < 100; i += 2) boxes[i] = {{-1, -1, -10}, {1, 1, -9}};
  ObjectHierarchy hierarchy(boxes);
  const Frustum frustum = frustum_of(clip_from_camera({}, 1.0));
  std::vector<ObjectId> found;
  hierarchy.collect_in_frustum(frustum, found);
  EXPECT_EQ(found.size(), 50u);
  const ObjectId shown{1};
  hierarchy.move({&shown, 1}, {&boxes[0], 1});
  hierarchy.collect_in_frustum(frustum, found);
  EXPECT_EQ(found.size(), 51u);
  EXPECT_EQ(found[1], shown);
}

TEST(ObjectHierarchy, SurvivesHopelessSpreads) {
  std::vector<Aabb> same(1000, Aabb{{0, 0, -5}, {1, 1, -4}});
  std::vector<Aabb> exponential;
  for (int i = 0; i < 2000; ++i) {
    const float x = std::ldexp(1.0f, i % 250 - 125);
    exponential.push_back({{x, 0, -5}, {x, 1, -4}});
  }
  std::vector<Aabb> unbounded(50, Aabb{glm::vec3(-INFINITY), glm::vec3(INFINITY)});
  const Frustum frustum = frustum_of(clip_from_camera({}, 1.0));
  for (const auto& boxes : {same, exponential, unbounded}) {
    const ObjectHierarchy hierarchy(boxes);
    std::vector<ObjectId> found;
    hierarchy.collect_in_frustum(frustum, found);
    EXPECT_EQ(found, plain_loop(frustum, boxes));
  }
}

TEST(ObjectHierarchy, AllocatesNothingOnceTheResultFits) {
  const auto boxes = random_boxes(5000, 7);
  const ObjectHierarchy hierarchy(boxes);
  std::mt19937_64 random(7);
  const Frustum frustum = random_frustum(random);
  std::vector<ObjectId> found;
  hierarchy.collect_in_frustum(frustum, found);
  const auto* const data = found.data();
  const std::size_t capacity = found.capacity();
  hierarchy.collect_in_frustum(frustum, found);
  EXPECT_EQ(found.data(), data);
  EXPECT_EQ(found.capacity(), capacity);
}

TEST(SortObjectIds, AgreesWithAPlainSort) {
  std::mt19937_64 random(8);
  for (const std::uint32_t object_count : {1u, 31u, 32u, 33u, 1000u, 100000u}) {
    for (const double share : {0.001, 0.02, 0.5, 1.0}) {
      std::vector<ObjectId> ids;
      for (std::uint32_t i = 0; i < object_count; ++i) {
        if (std::uniform_real_distribution<double>()(random) <= share) ids.push_back(ObjectId{i});
      }
      const std::vector<ObjectId> sorted = ids;
      std::shuffle(ids.begin(), ids.end(), random);
      sort_object_ids(ids, object_count);
      EXPECT_EQ(ids, sorted);
    }
  }
}

}  // namespace
}  // namespace sightline
