#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "main_view/client/pose_history.hpp"

namespace sightline {
namespace {

using Added = PoseHistory::Added;
constexpr double k_degree = 3.141592653589793 / 180.0;

glm::dquat yaw(double angle_rad) {
  return {std::cos(angle_rad / 2.0), 0.0, std::sin(angle_rad / 2.0), 0.0};
}
TimedPose at(double time_s, double x_m, double yaw_deg = 0.0) {
  return {time_s, {{x_m, 0.0, 0.0}, yaw(yaw_deg * k_degree)}};
}

TEST(PoseHistory, KeepsTheWindowAndForgetsTheOldest) {
  CullingOptions options;
  options.predictor_window = 4;
  PoseHistory history(options);
  for (int i = 0; i < 10; ++i) history.add(at(i / 60.0, 0.01 * i));
  ASSERT_EQ(history.samples().size(), 4u);
  EXPECT_EQ(history.samples().front().time_s, 6 / 60.0);
  EXPECT_EQ(history.newest().time_s, 9 / 60.0);
}

TEST(PoseHistory, ReplacesThePoseOfTheSameTimeAndIgnoresAnEarlierOne) {
  PoseHistory history{CullingOptions{}};
  history.add(at(1.0, 0.0));
  history.add(at(1.1, 0.1));
  EXPECT_EQ(history.add(at(1.1, 0.2)), Added::continued);
  EXPECT_EQ(history.samples().size(), 2u);
  EXPECT_EQ(history.newest().pose.position_m.x, 0.2);
  EXPECT_EQ(history.add(at(1.05, 0.3)), Added::ignored);
  EXPECT_EQ(history.newest().pose.position_m.x, 0.2);
}

TEST(PoseHistory, RefusesPosesThatAreNotFinite) {
  PoseHistory history{CullingOptions{}};
  history.add(at(0.0, 0.0));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinity, -infinity}) {
    EXPECT_THROW(history.add({bad, {}}), InputError);
    EXPECT_THROW(history.add({1.0, {{0.0, bad, 0.0}, yaw(0.0)}}), InputError);
    EXPECT_THROW(history.add({1.0, {{0.0, 0.0, 0.0}, {1.0, bad, 0.0, 0.0}}}), InputError);
  }
  EXPECT_THROW(history.add({1.0, {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0, 0.0}}}), InputError);
  EXPECT_EQ(history.samples().size(), 1u);
}

TEST(PoseHistory, TakesAFastHeadTurnForAMotion) {
  for (const double degrees_a_second : {90.0, 300.0, 600.0}) {
    PoseHistory history{CullingOptions{}};
    history.add(at(0.0, 0.0));
    for (int i = 1; i < 60; ++i) {
      EXPECT_EQ(history.add(at(i / 60.0, 0.0, i / 60.0 * degrees_a_second)), Added::continued)
          << degrees_a_second;
    }
  }
}

TEST(PoseHistory, TakesSixtyDegreesInAFrameForAJump) {
  PoseHistory history{CullingOptions{}};
  for (int i = 0; i < 30; ++i) history.add(at(i / 60.0, 0.0, 5.0 * i));
  EXPECT_EQ(history.add(at(0.5, 0.0, 5.0 * 29 + 60.0)), Added::jumped);
  EXPECT_EQ(history.samples().size(), 1u);
}

TEST(PoseHistory, TakesATeleportForAJumpButNotAFastDrive) {
  PoseHistory walk{CullingOptions{}};
  for (int i = 0; i < 30; ++i) EXPECT_NE(walk.add(at(i / 60.0, 1.4 * i / 60.0)), Added::jumped);
  EXPECT_EQ(walk.add(at(0.5, 5.0)), Added::jumped);
  PoseHistory drive{CullingOptions{}};
  double x_m = 0.0;
  for (int i = 0; i < 300; ++i) {
    x_m += std::min(i * 0.3, 60.0) / 60.0;  // up to 60 m/s at 18 m/s^2
    EXPECT_NE(drive.add(at(i / 60.0, x_m)), Added::jumped) << i;
  }
}

TEST(PoseHistory, TakesADriveForOneJumpAtMostHoweverLongItsSteps) {
  for (const double step_m : {0.4, 0.6, 1.5, 10.0}) {
    PoseHistory history{CullingOptions{}};
    int jumps = 0;
    for (int i = 0; i < 100; ++i) {
      jumps += history.add({i / 60.0, {{i * step_m, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}}) ==
               PoseHistory::Added::jumped;
    }
    EXPECT_LE(jumps, 1) << step_m << " m a frame";
  }
}

TEST(PoseHistory, TakesEachOfTwoTeleportsInARowForAJump) {
  PoseHistory history{CullingOptions{}};
  const auto add = [&](double time_s, double x_m) {
    return history.add({time_s, {{x_m, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}});
  };
  add(0.0, 0.0);
  EXPECT_EQ(add(1.0 / 60, 100.0), PoseHistory::Added::jumped);
  EXPECT_EQ(add(2.0 / 60, -50.0), PoseHistory::Added::jumped);
  EXPECT_EQ(add(3.0 / 60, -50.1), PoseHistory::Added::continued);
}

TEST(PoseHistory, StartsAnewAfterAPause) {
  PoseHistory history{CullingOptions{}};
  history.add(at(0.0, 0.0));
  history.add(at(0.1, 0.01));
  EXPECT_EQ(history.add(at(3.0, 0.02)), Added::restarted);
  EXPECT_EQ(history.samples().size(), 1u);
}

TEST(PoseHistory, KeepsQuaternionSignsContinuous) {
  PoseHistory history{CullingOptions{}};
  for (int i = 0; i < 20; ++i) {
    TimedPose sample = at(i / 60.0, 0.0, 9.0 * i);
    if (i % 3 == 0) sample.pose.world_from_camera = -sample.pose.world_from_camera;
    history.add(sample);
    EXPECT_EQ(history.newest().pose, sample.pose);
  }
  const auto samples = history.samples();
  for (std::size_t i = 1; i < samples.size(); ++i) {
    EXPECT_GT(glm::dot(samples[i - 1].pose.world_from_camera, samples[i].pose.world_from_camera), 0.9);
  }
}

TEST(CullingOptions, NamesTheFieldThatIsWrong) {
  const auto message_of = [](auto change) {
    CullingOptions options;
    change(options);
    try {
      options.validate();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message_of([](CullingOptions&) {}), "");
  EXPECT_NE(message_of([](CullingOptions& o) { o.predictor_order = 9; }).find("predictor_order"),
            std::string::npos);
  EXPECT_NE(message_of([](CullingOptions& o) { o.predictor_window = 2; }).find("predictor_window"),
            std::string::npos);
  EXPECT_NE(message_of([](CullingOptions& o) { o.max_staleness_s = -1.0; }).find("max_staleness_s"),
            std::string::npos);
  EXPECT_NE(message_of([](CullingOptions& o) { o.min_guard_rad = std::nan(""); }).find("min_guard_rad"),
            std::string::npos);
}

}  // namespace
}  // namespace sightline
