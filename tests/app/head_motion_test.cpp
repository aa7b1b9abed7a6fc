#include "main_view/app/head_motion.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "tests/common/glb_file.hpp"
#include "tests/common/test_scenes.hpp"

namespace sightline {
namespace {

constexpr double k_degree = std::numbers::pi / 180.0;

glm::dquat about(const glm::dvec3& axis, double angle_rad) {
  return glm::angleAxis(angle_rad, glm::normalize(axis));
}

Pose path_pose() {
  return {{3.0, 1.7, -2.0}, about({0, 1, 0}, 0.7) * about({1, 0, 0}, -0.2)};
}

/// Nods by `nod_rad(t)` about its own X, whatever its world axes and wherever it looked first.
CameraPath nodding(const glm::dquat& world_axes, double (*nod_rad)(double), double first_s, double last_s) {
  CameraPath path;
  for (double t = first_s; t <= last_s + 1e-9; t += 0.01) {
    path.samples.push_back({t, {{t, 0, 0}, world_axes * about({1, 0, 0}, nod_rad(t))}});
  }
  return path;
}

double ramp(double t) {
  return 0.3 * t;
}

void expect_same_rotation(const glm::dquat& a, const glm::dquat& b, const std::string& what) {
  EXPECT_LT(rotation_angle_rad(a, b), 1e-9) << what;
}

std::string refusal_of(const HeadMotionOptions& options) {
  try {
    options.validate();
    (void)HeadMotion(options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(HeadMotion, ChangesNothingWithoutAMotion) {
  EXPECT_EQ(HeadMotion().applied_to(path_pose(), 12.3), path_pose());
}

TEST(HeadMotion, LaysARecordedRotationOverThePathWhateverItsWorldAxes) {
  for (const glm::dquat& axes :
       {glm::dquat(1, 0, 0, 0), about({1, 0, 0}, 90 * k_degree), about({1, 2, 3}, 2.0)}) {
    const HeadMotion motion(nodding(axes, ramp, 0.0, 2.0), 0.0);
    for (const double t : {0.0, 0.005, 0.5, 1.234}) {
      const Pose turned = motion.applied_to(path_pose(), t);
      EXPECT_EQ(turned.position_m, path_pose().position_m);
      expect_same_rotation(turned.world_from_camera,
                           path_pose().world_from_camera * about({1, 0, 0}, 0.3 * t), std::to_string(t));
    }
  }
}

TEST(HeadMotion, RunsARecordingBackwardsWhenItsEndIsReached) {
  const HeadMotion motion(nodding({1, 0, 0, 0}, ramp, 0.0, 2.0), 0.0);
  const auto at = [&](double t) { return motion.applied_to(path_pose(), t).world_from_camera; };
  expect_same_rotation(at(2.5), at(1.5), "on the way back");
  expect_same_rotation(at(4.0), at(0.0), "back at the start");
  expect_same_rotation(at(4.25), at(0.25), "forwards again");
  expect_same_rotation(at(40.25), at(0.25), "long after");
}

TEST(HeadMotion, TakesTheLongestStretchBetweenGaps) {
  CameraPath recorded = nodding(
      {1, 0, 0, 0}, [](double) { return 1.0; }, 0.0, 0.5);
  const CameraPath longest = nodding({1, 0, 0, 0}, ramp, 1.0, 3.0);
  const CameraPath last = nodding(
      {1, 0, 0, 0}, [](double) { return 2.0; }, 3.2, 3.9);
  recorded.samples.insert(recorded.samples.end(), longest.samples.begin(), longest.samples.end());
  recorded.samples.insert(recorded.samples.end(), last.samples.begin(), last.samples.end());
  const HeadMotion motion(recorded, 0.0);
  expect_same_rotation(motion.applied_to(path_pose(), 1.5).world_from_camera,
                       path_pose().world_from_camera * about({1, 0, 0}, 0.45), "within the second stretch");
}

TEST(HeadMotion, TurnsByHalfACircleAndReachesItsSpeed) {
  for (const double speed : {60.0, 180.0, 300.0, 1500.0}) {
    SCOPED_TRACE(speed);
    const HeadMotion motion(std::nullopt, speed);
    const auto yaw = [&](double t) { return motion.applied_to(path_pose(), t).world_from_camera; };
    expect_same_rotation(yaw(HeadMotion::k_still_s), path_pose().world_from_camera, "still at first");
    const double turning_s = 180.0 / speed + HeadMotion::k_ramp_s;
    expect_same_rotation(yaw(HeadMotion::k_still_s + turning_s + 0.1),
                         about({0, 1, 0}, std::numbers::pi) * path_pose().world_from_camera, "looks back");
    double fastest = 0.0;
    for (double t = 0.0; t < 20.0; t += 0.001) {
      fastest = std::max(fastest, rotation_angle_rad(yaw(t), yaw(t + 0.001)) / 0.001 / k_degree);
    }
    EXPECT_NEAR(fastest, speed, 0.01 * speed);
  }
}

TEST(HeadMotion, JumpsWithInfiniteSpeed) {
  const HeadMotion motion(std::nullopt, std::numeric_limits<double>::infinity());
  const auto yaw = [&](double t) { return motion.applied_to(path_pose(), t).world_from_camera; };
  expect_same_rotation(yaw(1.999), path_pose().world_from_camera, "before");
  expect_same_rotation(yaw(2.001), about({0, 1, 0}, std::numbers::pi) * path_pose().world_from_camera,
                       "after");
  expect_same_rotation(yaw(4.001), path_pose().world_from_camera, "after the second");
}

TEST(HeadMotion, RefusesWhatItCannotFollow) {
  for (const double speed : {-1.0, 1501.0, std::nan(""), -std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(refusal_of({{}, speed}), ::testing::HasSubstr("--turn")) << speed;
  }
  const testing::TemporaryFolder folder;
  const auto file = folder / "head.csv";
  EXPECT_THAT(refusal_of({file, 0.0}), ::testing::HasSubstr("head.csv"));
  testing::write_text(file, "t,px,py,pz,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n1,0,0,0,1,0,0,0\n");
  EXPECT_THAT(refusal_of({file, 0.0}), ::testing::HasSubstr("head.csv"));
  testing::write_text(file, "t,px,py,pz,qw,qx,qy,qz\n0,0,0,0,0,0,0,0\n");
  EXPECT_THAT(refusal_of({file, 0.0}), ::testing::HasSubstr("line 2"));
}

}  // namespace
}  // namespace sightline
