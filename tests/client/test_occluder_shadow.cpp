#include <cmath>
#include <random>

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "main_view/client/occluder_shadow.hpp"

namespace sightline {
namespace {

Aabb float_box(const WorldBox& box) {
  Aabb result;
  for (int axis = 0; axis < 3; ++axis) {
    result.min[axis] = std::nextafter(static_cast<float>(box.min[axis]), -INFINITY);
    result.max[axis] = std::nextafter(static_cast<float>(box.max[axis]), INFINITY);
  }
  return result;
}

/// Whether the straight way from one point to another meets the box. The plain slow version.
bool meets(const glm::dvec3& from, const glm::dvec3& to, const WorldBox& box) {
  double begin = 0.0, end = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double way = to[axis] - from[axis];
    double enter = (box.min[axis] - from[axis]) / way, leave = (box.max[axis] - from[axis]) / way;
    if (enter > leave) std::swap(enter, leave);
    begin = std::max(begin, enter);
    end = std::min(end, leave);
  }
  return begin <= end;
}

struct Random {
  std::mt19937 engine{31};
  double operator()(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  }
  glm::dvec3 vec(double reach) {
    return {(*this)(-reach, reach), (*this)(-reach, reach), (*this)(-reach, reach)};
  }
  WorldBox box(const glm::dvec3& center, double largest) {
    const glm::dvec3 half{(*this)(0.01, largest), (*this)(0.01, largest), (*this)(0.01, largest)};
    return {center - half, center + half};
  }
  glm::dvec3 in(const WorldBox& box) {
    return {(*this)(box.min.x, box.max.x), (*this)(box.min.y, box.max.y), (*this)(box.min.z, box.max.z)};
  }
};

Eye eye_at(const glm::dvec3& position, Random& random, const glm::dmat4& projection) {
  const glm::dquat turn =
      glm::normalize(glm::dquat(random(-1, 1), random(-1, 1), random(-1, 1), random(-1, 1)));
  return {camera_from_world(Pose{position, turn}), projection};
}

const glm::dmat4 k_perspective = clip_from_camera(Perspective{}, 4.0 / 3.0);

TEST(OccluderShadow, HoldsEveryBoxWithAPointBehindTheOccluder) {
  Random random;
  std::size_t held = 0, shadowed = 0, tested = 0;
  for (const double far : {0.0, 4e6}) {
    for (int i = 0; i < 20000; ++i) {
      const glm::dvec3 origin = random.vec(far), from = origin + random.vec(6.0);
      const WorldBox occluder = random.box(origin + random.vec(3.0), 1.5);
      const double slack = i % 3 == 0 ? random(0.0, 0.3) : 0.0;
      const OccluderShadow shadow(eye_at(from, random, k_perspective), occluder, slack);
      // About the line through both, from before the occluder to far behind it.
      const glm::dvec3 through = 0.5 * (occluder.min + occluder.max) - from;
      const WorldBox object = random.box(from + through * random(0.5, 4.0) + random.vec(3.0), 0.8);
      bool truly = false;
      for (int sample = 0; sample < 40 && !truly; ++sample) {
        const glm::dvec3 way = random.vec(1.0);
        const glm::dvec3 seen_from = from + way * (slack / std::max(glm::length(way), 1.0));
        truly = meets(seen_from, random.in(object), occluder);
      }
      const bool may = shadow.may_hold(float_box(object));
      ASSERT_TRUE(may || !truly) << "case " << i << " at " << far;
      ++tested;
      held += may;
      shadowed += truly;
    }
  }
  EXPECT_GT(shadowed, tested / 5);
  EXPECT_LT(held, tested * 3 / 4);  // not everything
}

TEST(OccluderShadow, HoldsEveryBoxBehindTheOccluderAlongParallelRays) {
  Random random;
  std::size_t held = 0, shadowed = 0;
  for (int i = 0; i < 10000; ++i) {
    const WorldBox occluder = random.box(random.vec(3.0), 1.5);
    glm::dmat4 projection = glm::ortho(-5.0, 7.0, -4.0, 6.0, 0.1, 100.0);
    if (i % 2 == 0) projection[2][0] = random(-0.1, 0.1);  // oblique
    const Eye eye = eye_at(random.vec(3.0), random, projection);
    const OccluderShadow shadow(eye, occluder, 0.0);
    const WorldBox object = random.box(0.5 * (occluder.min + occluder.max) + random.vec(3.0), 0.8);
    const glm::dmat4 world_from_clip = glm::inverse(eye.clip_from_world());
    bool truly = false;
    for (int sample = 0; sample < 40 && !truly; ++sample) {
      const glm::dvec3 point = random.in(object);
      // Towards the eye, that is, to the near side and far beyond it.
      glm::dvec4 clip = eye.clip_from_world() * glm::dvec4(point, 1.0);
      clip.z -= 10.0;
      truly = meets(glm::dvec3(world_from_clip * clip), point, occluder);
    }
    const bool may = shadow.may_hold(float_box(object));
    ASSERT_TRUE(may || !truly) << "case " << i;
    held += may;
    shadowed += truly;
  }
  EXPECT_GT(shadowed, 1000u);
  EXPECT_LT(held, 7500u);
}

TEST(OccluderShadow, OfAFlatWallIsWhatLiesBehindIt) {
  Random random;
  Eye eye = eye_at({0, 0, 0}, random, k_perspective);
  const OccluderShadow shadow(eye, {{-1, -1, -5}, {1, 1, -5}}, 0.0);
  const auto holds = [&](const glm::vec3& point) { return shadow.may_hold({point - 0.01f, point + 0.01f}); };
  EXPECT_TRUE(holds({0, 0, -6}));
  EXPECT_TRUE(holds({1.9f, 1.9f, -10}));
  EXPECT_FALSE(holds({2.1f, 0, -10}));
  EXPECT_FALSE(holds({0, -2.1f, -10}));
  EXPECT_FALSE(holds({0, 0, -4.9f}));
  EXPECT_FALSE(holds({0, 0, 6}));
  EXPECT_FALSE(shadow.may_hold(Aabb{}));
}

TEST(OccluderShadow, IsEverythingFromWithinAndForOddProjections) {
  Random random;
  const Aabb anywhere{glm::vec3(100.0f), glm::vec3(101.0f)};
  const WorldBox box{glm::dvec3(-1.0), glm::dvec3(1.0)};
  EXPECT_TRUE(OccluderShadow(eye_at({0.5, 0.5, 0.5}, random, k_perspective), box, 0.0).may_hold(anywhere));
  EXPECT_TRUE(OccluderShadow(eye_at({1.5, 0, 0}, random, k_perspective), box, 0.6).may_hold(anywhere));
  EXPECT_FALSE(OccluderShadow(eye_at({1.5, 0, 0}, random, k_perspective), box, 0.0).may_hold(anywhere));
  glm::dmat4 odd = k_perspective;
  odd[0][3] = 0.1;
  EXPECT_TRUE(OccluderShadow(eye_at({0, 0, 5}, random, odd), box, 0.0).may_hold(anywhere));
}

}  // namespace
}  // namespace sightline
