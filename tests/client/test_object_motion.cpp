#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include <glm/ext/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "main_view/client/object_motion.hpp"

namespace sightline {
namespace {

const Aabb k_bounds{{-0.6f, 0.0f, -0.05f}, {0.7f, 2.0f, 0.05f}};
const glm::dvec3 k_up(0, 1, 0);

using Way = std::function<glm::dmat4(double)>;

/// Worst reach out of a box foretold 50 to 150 ms ahead, after `steps` steps of 1/60 s; over many starts.
double worst_excess_m(const Way& way, int steps) {
  double worst = 0.0;
  for (double start_s = 0.0; start_s < 2.0; start_s += 0.037) {
    ObjectMotion motion(k_bounds, glm::dmat4x3(way(start_s)));
    double now_s = start_s;
    for (int i = 0; i < steps; ++i) {
      EXPECT_TRUE(motion.step(now_s, now_s + 1 / 60.0, glm::dmat4x3(way(now_s + 1 / 60.0))));
      now_s += 1 / 60.0;
    }
    const WorldBox foretold = motion.bounds_between(now_s + 0.05, now_s + 0.15);
    for (double ahead_s = 0.05; ahead_s <= 0.15; ahead_s += 0.0031) {
      const ObjectMotion there(k_bounds, glm::dmat4x3(way(now_s + ahead_s)));
      worst = std::max(worst, excess_m(foretold, there.bounds()));
    }
  }
  return worst;
}

glm::dmat4 hinged(double angle) {
  return glm::rotate(glm::translate(glm::dmat4(1.0), {7, 0, 3}), angle, k_up) *
         glm::translate(glm::dmat4(1.0), {0.65, 0, 0});
}

TEST(ObjectMotion, ForetellsStraightWaysDoorsFansAndWheelsOnceItKnowsThem) {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(0.3, 1.0, -0.2));
  const Way straight = [](double t) {
    return glm::translate(glm::dmat4(1.0), {4.0 * t, 1.0 - 0.3 * t, 2.0 * t});
  };
  const Way door = [](double t) { return hinged(2.0 * t); };
  const Way fan = [=](double t) {
    return glm::rotate(glm::translate(glm::dmat4(1.0), {5, 1, 2}), 11.0 * t, axis) *
           glm::translate(glm::dmat4(1.0), {-0.05, -1.0, 0.0});  // about the bounds' centre
  };
  const Way wheel = [=](double t) {
    return glm::translate(glm::dmat4(1.0), {6.0 * t, 0, 0}) *
           glm::rotate(glm::dmat4(1.0), 15.0 * t, {0, 0, 1}) *
           glm::translate(glm::dmat4(1.0), {-0.05, -1.0, 0.0});
  };
  for (const Way& way : {straight, door, fan, wheel}) EXPECT_LT(worst_excess_m(way, 3), 1e-6);
  // After one step nothing is known of a bend.
  EXPECT_LT(worst_excess_m(straight, 1), 1e-6);
  EXPECT_LT(worst_excess_m(fan, 1), 1e-6);
  EXPECT_LT(worst_excess_m(door, 1), 0.03);
}

TEST(ObjectMotion, ForetellsFarFromTheOriginAsWellAsNearIt) {
  const glm::dvec3 far(4e6, 0, -3e6);
  const Way door = [=](double t) { return glm::translate(glm::dmat4(1.0), far) * hinged(2.0 * t); };
  EXPECT_LT(worst_excess_m(door, 3), 1e-4);
}

TEST(ObjectMotion, KeepsTheBoxOfASlowObjectTight) {
  ObjectMotion motion(k_bounds, glm::dmat4x3(hinged(0.0)));
  ASSERT_TRUE(motion.step(0.0, 1 / 60.0, glm::dmat4x3(hinged(0.002))));
  const WorldBox here = motion.bounds(), soon = motion.bounds_between(0.05, 0.15);
  EXPECT_LT(excess_m(here, soon), 0.05);
  motion.stop();
  EXPECT_LT(excess_m(motion.bounds(), motion.bounds_between(0.05, 10.0)), 1e-9);
}

TEST(ObjectMotion, TakesNoSpeedFromAJump) {
  ObjectMotion motion(k_bounds, glm::dmat4x3(1.0));
  const auto at_x = [](double x) { return glm::dmat4x3(glm::translate(glm::dmat4(1.0), {x, 0, 0})); };
  EXPECT_FALSE(motion.step(0.0, 1 / 60.0, at_x(20.0)));
  EXPECT_EQ(motion.speed_m_per_s(), 0.0);
  EXPECT_LT(excess_m(motion.bounds(), motion.bounds_between(0.1, 0.2)), 1e-9);
  // A fast thing jumps once and then is known to be fast.
  EXPECT_TRUE(motion.step(1 / 60.0, 2 / 60.0, at_x(21.0)));
  EXPECT_NEAR(motion.speed_m_per_s(), 60.0, 1e-9);
}

TEST(ObjectMotion, SurvivesPlacementsNoObjectHas) {
  const double huge = 1e300, tiny = 1e-300;
  for (const double scale : {0.0, tiny, -1.0, huge}) {
    ObjectMotion motion(k_bounds, glm::dmat4x3(1.0));
    glm::dmat4x3 odd(scale);
    (void)motion.step(0.0, 0.01, odd);
    odd[3] = {0.1, 0.1, 0.1};
    (void)motion.step(0.01, 0.02, odd);
    (void)motion.step(0.02, 0.02, glm::dmat4x3(1.0));
    (void)motion.step(0.02, 0.01, glm::dmat4x3(1.0));
    const WorldBox box = motion.bounds_between(0.0, 1.0);
    EXPECT_LE(box.min.x, box.max.x) << scale;
  }
}

}  // namespace
}  // namespace sightline
