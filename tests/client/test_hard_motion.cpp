// What trackers really deliver: jumps, gaps, dropped and doubled poses, uneven rates, flipped signs. Both
// kinds of predictor must bear it.

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "main_view/client/motion_predictor.hpp"

namespace sightline {
namespace {

constexpr double k_step_s = 1.0 / 60.0;
constexpr double k_lead_s = 0.1;

glm::dquat turned(double angle_rad, const glm::dvec3& axis = {0.0, 1.0, 0.0}) {
  return glm::angleAxis(angle_rad, glm::normalize(axis));
}

/// Walks at 1.4 m/s and turns at 1 rad/s: what every predictor follows exactly when nothing disturbs it.
Pose steady(double t) {
  return {{1.4 * t, 1.7, -0.5 * t}, turned(t, {0.2, 1.0, 0.1})};
}

class HardMotion : public ::testing::TestWithParam<PredictorKind> {
 protected:
  static CullingOptions options() {
    CullingOptions options;
    options.predictor = GetParam();
    return options;
  }

  PoseHistory::Added add(const TimedPose& sample) {
    const auto added = history_.add(sample);
    if (added != PoseHistory::Added::continued) predictor_.forget_pending();
    predictor_.observe(history_);
    return added;
  }
  PredictedPose ahead(double lead_s = k_lead_s) {
    return predictor_.predict(history_, history_.newest().time_s + lead_s);
  }
  /// Distance of the prediction from the steady motion, metres, and whether it is a pose at all.
  double off_m(double lead_s = k_lead_s) {
    const PredictedPose predicted = ahead(lead_s);
    EXPECT_TRUE(std::isfinite(predicted.position_error_m) && predicted.position_error_m >= 0.0);
    EXPECT_TRUE(predicted.rotation_error_rad >= 0.0 && predicted.rotation_error_rad < 3.15);
    EXPECT_NEAR(glm::length(predicted.pose.world_from_camera), 1.0, 1e-9);
    const Pose truth = steady(history_.newest().time_s + lead_s);
    return glm::length(predicted.pose.position_m - truth.position_m);
  }
  double off_rad(double lead_s = k_lead_s) {
    const Pose truth = steady(history_.newest().time_s + lead_s);
    return rotation_angle_rad(ahead(lead_s).pose.world_from_camera, truth.world_from_camera);
  }
  void walk(int first, int end) {
    for (int i = first; i < end; ++i) add({i * k_step_s, steady(i * k_step_s)});
  }

  PoseHistory history_{options()};
  MotionPredictor predictor_{options()};
};

INSTANTIATE_TEST_SUITE_P(Kinds, HardMotion, ::testing::Values(PredictorKind::fixed, PredictorKind::adaptive),
                         [](const ::testing::TestParamInfo<PredictorKind>& kind) {
                           return kind.param == PredictorKind::fixed ? "fixed" : "adaptive";
                         });

TEST_P(HardMotion, LosesNothingByAGap) {
  for (const int lost : {1, 6, 15, 28}) {  // up to just below pose_gap_s
    walk(0, 60);
    walk(60 + lost, 61 + lost);
    EXPECT_LT(off_m(), 0.01) << lost;
    EXPECT_LT(off_rad(), 0.01) << lost;
    walk(61 + lost, 120);
    history_.clear();
    predictor_.forget_pending();
  }
}

TEST_P(HardMotion, LosesNothingByDroppedPosesAndUnevenRates) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  double time_s = 0.0;
  for (int i = 0; i < 600; ++i) {
    time_s += uniform(random) < 0.2 ? 0.06 : 0.001 + 0.03 * uniform(random);
    add({time_s, steady(time_s)});
    if (i < 30) continue;
    EXPECT_LT(off_m(), 0.01) << i;
    EXPECT_LT(off_rad(), 0.01) << i;
  }
}

TEST_P(HardMotion, ForgetsATrackingJumpThatComesBack) {
  // Within a window of poses the paper's fit feels it. It says so.
  walk(0, 60);
  Pose away = steady(1.0);
  away.position_m.y += 0.4;
  away.world_from_camera = away.world_from_camera * turned(0.3);
  add({60 * k_step_s, away});
  EXPECT_LT(off_m(), ahead().position_error_m + 0.6);
  walk(61, 90);
  EXPECT_LT(off_m(), 0.01);
  EXPECT_LT(off_rad(), 0.01);
}

TEST_P(HardMotion, GoesOnFromATrackingJumpThatStays) {
  const glm::dvec3 aside(3.0, 0.0, 0.0);
  walk(0, 60);
  for (int i = 60; i < 90; ++i) {
    const Pose pose = steady(i * k_step_s);
    const auto added = add({i * k_step_s, {pose.position_m + aside, pose.world_from_camera}});
    EXPECT_EQ(added == PoseHistory::Added::jumped, i == 60) << i;
    if (i < 64) continue;
    const glm::dvec3 truth = steady(i * k_step_s + k_lead_s).position_m + aside;
    EXPECT_LT(glm::length(ahead().pose.position_m - truth), 0.02) << i;
  }
}

TEST_P(HardMotion, BearsATrackerThatFreezesAndCatchesUp) {
  walk(0, 60);
  for (int i = 60; i < 66; ++i) {
    add({i * k_step_s, steady(59 * k_step_s)});
    EXPECT_LT(off_m(), 0.5) << i;
  }
  for (int i = 66; i < 72; ++i) {
    walk(i, i + 1);
    EXPECT_LT(off_m(), 1.0) << i;
  }
  walk(72, 120);
  EXPECT_LT(off_m(), 0.01);
  EXPECT_LT(off_rad(), 0.01);
}

TEST_P(HardMotion, IsTheSameWithFlippedQuaternionSigns) {
  std::mt19937 random(2);
  PoseHistory flipped(options());
  MotionPredictor other(options());
  for (int i = 0; i < 240; ++i) {
    const double t = i * k_step_s;
    // More than half a turn to and fro: through every sign.
    TimedPose sample{t, {{0.1 * std::sin(2.0 * t), 0.0, 0.0}, turned(4.0 * std::sin(1.5 * t))}};
    add(sample);
    if (random() % 2 == 0) sample.pose.world_from_camera = -sample.pose.world_from_camera;
    flipped.add(sample);
    other.observe(flipped);
    const PredictedPose a = ahead();
    const PredictedPose b = other.predict(flipped, t + k_lead_s);
    EXPECT_LT(rotation_angle_rad(a.pose.world_from_camera, b.pose.world_from_camera), 1e-5) << i;
    EXPECT_NEAR(a.rotation_error_rad, b.rotation_error_rad, 1e-5) << i;
  }
}

TEST_P(HardMotion, TakesTheLastOfSeveralPosesOfOneTime) {
  for (int i = 0; i < 120; ++i) {
    const double t = i * k_step_s;
    Pose wrong = steady(t);
    wrong.position_m.x += 0.01;
    add({t, wrong});
    add({t, steady(t)});
    add({t, steady(t)});
    if (i < 30) continue;
    EXPECT_LT(off_m(), 0.02) << i;
  }
}

TEST_P(HardMotion, IsNotThrownByPosesANanosecondApart) {
  // Two drivers that stamp the same pose anew, with a millimetre and a milliradian of noise: as a speed, that
  // would be a thousand kilometres a second.
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (const double apart_s : {1e-12, 1e-9, 1e-6, 1e-4}) {
    for (int i = 0; i < 90; ++i) {
      const double t = i * k_step_s;
      for (const double time_s : {t, t + apart_s}) {
        Pose pose = steady(time_s);
        pose.position_m += 0.001 * glm::dvec3(normal(random), normal(random), normal(random));
        pose.world_from_camera = pose.world_from_camera * turned(0.001 * normal(random));
        EXPECT_NE(add({time_s, pose}), PoseHistory::Added::jumped);
        if (i < 30) continue;
        EXPECT_LT(off_m(), 0.15) << apart_s << ", " << i;
        EXPECT_LT(off_rad(), 0.15) << apart_s << ", " << i;
        EXPECT_LT(history_.speed_m_per_s(), 3.0) << apart_s;
        EXPECT_LT(history_.turn_speed_rad_per_s(), 3.0) << apart_s;
      }
    }
    history_.clear();
    predictor_.forget_pending();
  }
}

TEST_P(HardMotion, KeepsUpWithATrackerOfTenThousandPosesASecond) {
  for (int i = 0; i < 5000; ++i) {
    const double t = 1e-4 * i;
    add({t, steady(t)});
  }
  EXPECT_LT(off_m(0.01), 0.01);
  EXPECT_LT(off_rad(0.01), 0.01);
}

TEST_P(HardMotion, IsUnmovedByPosesThatAreRefused) {
  walk(0, 60);
  const PredictedPose before = ahead();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinity, -infinity}) {
    EXPECT_THROW(add({1.1, {{0.0, bad, 0.0}, turned(0.0)}}), InputError);
    EXPECT_THROW(add({1.1, {{0.0, 0.0, 0.0}, {bad, 0.0, 0.0, 0.0}}}), InputError);
    EXPECT_THROW(add({bad, steady(1.0)}), InputError);
  }
  EXPECT_THROW(add({1.1, {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0, 0.0}}}), InputError);
  EXPECT_EQ(add({0.5, steady(9.0)}), PoseHistory::Added::ignored);
  EXPECT_EQ(ahead().pose, before.pose);
  EXPECT_EQ(ahead().position_error_m, before.position_error_m);
}

TEST_P(HardMotion, StaysAPoseWhateverComes) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  double time_s = 0.0;
  for (int i = 0; i < 1500; ++i) {
    time_s += random() % 8 == 0 ? 0.0 : std::pow(10.0, -9.0 + 9.0 * std::abs(uniform(random)));
    const double size_m = std::pow(10.0, 12.0 * uniform(random));
    const glm::dquat q =
        glm::normalize(glm::dquat(uniform(random), uniform(random), uniform(random), uniform(random)));
    add({time_s, {size_m * glm::dvec3(uniform(random), uniform(random), uniform(random)), q}});
    for (const double lead_s : {1e-12, 0.05, 0.5, 1e4}) {
      const PredictedPose predicted = ahead(lead_s);
      ASSERT_TRUE(std::isfinite(glm::length(predicted.pose.position_m))) << i << ", " << lead_s;
      ASSERT_NEAR(glm::length(predicted.pose.world_from_camera), 1.0, 1e-6) << i << ", " << lead_s;
      ASSERT_TRUE(predicted.position_error_m >= 0.0) << i;
      ASSERT_TRUE(predicted.rotation_error_rad >= 0.0 && predicted.rotation_error_rad < 3.15) << i;
    }
  }
}

}  // namespace
}  // namespace sightline
