#include <algorithm>
#include <random>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>

#include "common/frustum.hpp"
#include "common/pose.hpp"
#include "main_view/client/seen_in_view.hpp"

namespace sightline {
namespace {

constexpr std::uint32_t k_objects = 400;

/// A request, points that one of its eyes saw, one an object, and in which directions.
class SeenPoints {
 public:
  explicit SeenPoints(std::uint32_t seed, std::size_t eyes) : random_(seed) {
    const Pose head{10.0 * direction(), rotation()};
    const StereoEyes two = stereo_eyes(head, 0.064);
    filed_.request.eyes = {eye_of(two.left)};
    if (eyes == 2) filed_.request.eyes.push_back(eye_of(two.right));
    std::vector<ObjectId> ids;
    std::vector<DirectionExtent> extents;
    for (std::uint32_t id = 0; id < k_objects; ++id) {
      const glm::dvec3 from = position_of(filed_.request.eyes[id % eyes]);
      const glm::dvec3 to = uniform(0.3, 20.0) * direction();
      points_.push_back(from + to);
      ids.push_back(ObjectId{2 * id});
      const glm::dvec3 right = 0.01 * glm::normalize(glm::cross(to, glm::dvec3(0.3, 1.0, 0.2)));
      const glm::dvec3 up = 0.01 * glm::normalize(glm::cross(right, to));
      extents.push_back(extent_of_piece({to - right - up, to + right - up, to + right + up, to - right + up},
                                        glm::length(to)));
    }
    filed_.set = VisibleSet(ids);
    filed_.set.set_extents(extents);
  }

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  glm::dvec3 direction() {
    std::normal_distribution<double> normal;
    return glm::normalize(glm::dvec3(normal(random_), normal(random_), normal(random_)));
  }
  glm::dquat rotation() { return glm::angleAxis(uniform(0.0, 6.28), direction()); }
  static Eye eye_of(const Pose& pose) {
    return {camera_from_world(pose), clip_from_camera(Perspective{}, 1.4)};
  }
  /// Near the request's eyes, looking anywhere.
  Eye eye_near(double offset_m) {
    return eye_of({position_of(filed_.request.eyes.front()) + offset_m * direction(), rotation()});
  }
  /// The side planes alone: what is before the near plane or behind the far one is in a direction of the
  /// view.
  [[nodiscard]] bool in_view(std::uint32_t point, const Eye& eye) const {
    const Frustum frustum = frustum_of(eye.clip_from_world());
    return std::all_of(frustum.planes.begin(), frustum.planes.begin() + 4, [&](const glm::dvec4& plane) {
      return glm::dot(plane, glm::dvec4(points_[point], 1.0)) >= 0.0;
    });
  }

  FiledSet filed_;

 private:
  std::mt19937 random_;
  std::vector<glm::dvec3> points_;
};

TEST(SeenInView, TellsWhereAnEyeIs) {
  SeenPoints seen(1, 1);
  for (int i = 0; i < 20; ++i) {
    const Pose pose{100.0 * seen.direction(), seen.rotation()};
    EXPECT_LT(glm::length(position_of(SeenPoints::eye_of(pose)) - pose.position_m), 1e-9);
  }
}

TEST(SeenInView, KeepsWhateverWasSeenWhereTheViewIsNow) {
  std::size_t kept_in_all = 0, views = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    SeenPoints seen(seed, 1 + seed % 2);
    for (const double offset_m : {0.0, 0.05, 0.4, 5.0}) {
      std::vector<Eye> eyes{seen.eye_near(offset_m)};
      if (seed % 3 == 0) eyes.push_back(seen.eye_near(offset_m));
      const VisibleSet kept = seen_in_view(seen.filed_, eyes);
      for (std::uint32_t id = 0; id < k_objects; ++id) {
        for (const Eye& eye : eyes) {
          if (!seen.in_view(id, eye)) continue;
          ASSERT_TRUE(kept.contains(ObjectId{2 * id})) << "seed " << seed << ", " << offset_m;
        }
      }
      for (const ObjectId id : kept.to_ids()) ASSERT_TRUE(seen.filed_.set.contains(id));
      if (offset_m > 0.1) continue;
      kept_in_all += kept.size();
      ++views;
    }
  }
  // A view is an eighth of all directions.
  EXPECT_LT(kept_in_all, views * k_objects / 2);
  EXPECT_GT(kept_in_all, 0u);
}

TEST(SeenInView, KeepsASetThatDoesNotSayWhere) {
  SeenPoints seen(3, 1);
  seen.filed_.set = VisibleSet(seen.filed_.set.to_ids());
  const Eye eye = seen.eye_near(0.0);
  EXPECT_EQ(seen_in_view(seen.filed_, {&eye, 1}), seen.filed_.set);
}

TEST(SeenInView, KeepsWhatMayBeAnywhereForAnyEyeAndNothingForNone) {
  SeenPoints seen(4, 2);
  seen.filed_.set.set_extents(std::vector<DirectionExtent>(k_objects, k_seen_anywhere));
  const Eye eye = seen.eye_near(3.0);
  EXPECT_EQ(seen_in_view(seen.filed_, {&eye, 1}), seen.filed_.set);
  EXPECT_EQ(seen_in_view(seen.filed_, {}).size(), 0u);
}

}  // namespace
}  // namespace sightline
