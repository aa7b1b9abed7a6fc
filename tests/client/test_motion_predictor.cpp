#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "main_view/client/motion_predictor.hpp"
#include "tests/client/predictor_options.hpp"
#include "tests/client/reference_fit.hpp"

namespace sightline {
namespace {

using testing::fixed_predictor;

constexpr double k_rate_hz = 60.0;

glm::dquat yaw(double angle_rad) {
  return {std::cos(angle_rad / 2.0), 0.0, std::sin(angle_rad / 2.0), 0.0};
}

TEST(PolynomialFit, AgreesWithTheClosedFormAndTheFullSolver) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int order = 0; order <= k_max_predictor_order; ++order) {
    for (int count = order + 1; count <= 24; ++count) {
      std::vector<double> times_s;
      std::vector<PoseComponents> values;
      double time_s = 1e5;
      for (int i = 0; i < count; ++i) {
        times_s.push_back(time_s += 0.005 + 0.02 * std::abs(normal(random)));
        values.emplace_back();
        for (double& value : values.back()) value = 1e3 + normal(random);
      }
      const double at_s = times_s.back() + 0.01;
      const Extrapolation fitted = fit_and_extrapolate(times_s, values, order, at_s);
      const PoseComponents closed = testing::closed_form_value(times_s, values, order, at_s);
      const PoseComponents full = testing::full_solver_value(times_s, values, order, at_s);
      for (std::size_t i = 0; i < closed.size(); ++i) {
        const double tolerance = 1e-7 * (1.0 + std::abs(closed[i]));
        EXPECT_NEAR(fitted.value[i], closed[i], tolerance) << "order " << order << ", samples " << count;
        EXPECT_NEAR(full[i], closed[i], tolerance) << "order " << order << ", samples " << count;
      }
      EXPECT_EQ(fitted.residuals_known, count > order + 1);
    }
  }
}

TEST(MotionPredictor, PredictsAPolynomialOfItsOrderToRounding) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int order = 0; order <= k_max_predictor_order; ++order) {
    const CullingOptions options = fixed_predictor(order, 20);
    PoseHistory history(options);
    MotionPredictor predictor(options);
    glm::dvec3 coefficient[5];
    for (auto& c : coefficient) c = 2.0 * glm::dvec3(uniform(random), uniform(random), uniform(random));
    const auto at = [&](double time_s) {
      glm::dvec3 position(2e6, 0.0, -3e5);  // far from the origin
      for (int i = 0; i <= order; ++i) position += coefficient[i] * std::pow(time_s, i);
      return position;
    };
    for (int i = 0; i < 20; ++i)
      ASSERT_NE(history.add({i / k_rate_hz, {at(i / k_rate_hz), yaw(0.3)}}), PoseHistory::Added::jumped);
    const double for_s = 25 / k_rate_hz;
    const PredictedPose predicted = predictor.predict(history, for_s);
    EXPECT_LT(glm::length(predicted.pose.position_m - at(for_s)), 1e-6) << "order " << order;
    EXPECT_LT(rotation_angle_rad(predicted.pose.world_from_camera, yaw(0.3)), 1e-7);
    EXPECT_LT(predicted.position_error_m, 1e-5);
  }
}

TEST(MotionPredictor, DoesNotPredictAPolynomialAboveItsOrder) {
  const CullingOptions options = fixed_predictor(1, 20);
  PoseHistory history(options);
  MotionPredictor predictor(options);
  for (int i = 0; i < 20; ++i)
    history.add({i / k_rate_hz, {{std::pow(i / k_rate_hz, 2), 0.0, 0.0}, yaw(0.0)}});
  const PredictedPose predicted = predictor.predict(history, 0.5);
  const double error_m = std::abs(predicted.pose.position_m.x - 0.25);
  EXPECT_GT(error_m, 0.01);
  EXPECT_GT(predicted.position_error_m, 0.0);
}

TEST(MotionPredictor, KeepsAStillCameraToTheBit) {
  const CullingOptions options;
  PoseHistory history(options);
  MotionPredictor predictor(options);
  const Pose pose{{0.1, 1.7, -1e6 / 3.0}, {0.8839912, 0.0742901, 0.4599417, -0.0386532}};
  for (int i = 0; i < 60; ++i) {
    history.add({i / k_rate_hz, pose});
    predictor.observe(history);
    const PredictedPose predicted = predictor.predict(history, i / k_rate_hz + 0.1);
    EXPECT_EQ(predicted.pose, pose);
    EXPECT_EQ(predicted.position_error_m, 0.0);
    EXPECT_EQ(predicted.rotation_error_rad, 0.0);
  }
}

TEST(MotionPredictor, GivesTheNewestPoseItselfAtHorizonZero) {
  const CullingOptions options;
  PoseHistory history(options);
  MotionPredictor predictor(options);
  Pose pose;
  for (int i = 0; i < 10; ++i) {
    pose = {{0.01 * i * i, 0.0, 0.0}, -yaw(0.03 * i)};
    history.add({i / k_rate_hz, pose});
  }
  const PredictedPose predicted = predictor.predict(history, 9 / k_rate_hz);
  EXPECT_EQ(predicted.pose, pose);
  EXPECT_EQ(predicted.position_error_m, 0.0);
  EXPECT_EQ(predicted.rotation_error_rad, 0.0);
}

TEST(MotionPredictor, IsNotHarmedByFlippedQuaternionSigns) {
  const CullingOptions options;
  PoseHistory plain(options);
  PoseHistory flipped(options);
  std::mt19937 random(3);
  for (int i = 0; i < 20; ++i) {
    const glm::dquat q = yaw(1.0 + 0.02 * i + 0.001 * i * i);
    plain.add({i / k_rate_hz, {{0.0, 0.0, 0.0}, q}});
    flipped.add({i / k_rate_hz, {{0.0, 0.0, 0.0}, random() % 2 == 0 ? q : -q}});
  }
  MotionPredictor a(options);
  MotionPredictor b(options);
  const PredictedPose from_plain = a.predict(plain, 0.4);
  const PredictedPose from_flipped = b.predict(flipped, 0.4);
  EXPECT_LT(rotation_angle_rad(from_plain.pose.world_from_camera, from_flipped.pose.world_from_camera), 1e-7);
  EXPECT_NEAR(from_plain.rotation_error_rad, from_flipped.rotation_error_rad, 1e-12);
  EXPECT_LT(rotation_angle_rad(from_plain.pose.world_from_camera, yaw(1.0 + 0.02 * 24 + 0.001 * 576)), 0.01);
}

TEST(MotionPredictor, WorksFromTheFirstPoseOn) {
  const CullingOptions options;
  PoseHistory history(options);
  MotionPredictor predictor(options);
  for (int i = 0; i < 5; ++i) {
    history.add({i / k_rate_hz, {{0.02 * i, 0.0, 0.0}, yaw(0.0)}});
    const double x = predictor.predict(history, (i + 2) / k_rate_hz).pose.position_m.x;
    EXPECT_NEAR(x, i == 0 ? 0.0 : 0.02 * (i + 2), 1e-9) << i;
  }
}

TEST(MotionPredictor, AnnouncesTheErrorsItMadeBefore) {
  // Order 0 over 1 holds the last pose; at a constant speed its error is known.
  const CullingOptions options = fixed_predictor(0, 1);
  PoseHistory history(options);
  MotionPredictor predictor(options);
  PredictedPose predicted;
  for (int i = 0; i < 30; ++i) {
    history.add({i / k_rate_hz, {{0.02 * i, 0.0, 0.0}, yaw(0.01 * i)}});
    predictor.observe(history);
    predicted = predictor.predict(history, (i + 3) / k_rate_hz);
  }
  EXPECT_NEAR(predicted.position_error_m, MotionPredictor::k_memory_error_factor * 0.06, 1e-9);
  EXPECT_NEAR(predicted.rotation_error_rad, MotionPredictor::k_memory_error_factor * 0.03, 1e-9);
  EXPECT_LE(MotionPredictor::k_memory_error_factor * 0.08 - 1e-9,
            predictor.predict(history, 29 / k_rate_hz + 4 / k_rate_hz).position_error_m);
}

TEST(MotionPredictor, ForgetsOldErrors) {
  const CullingOptions options = fixed_predictor(1, 2);
  PoseHistory history(options);
  MotionPredictor predictor(options);
  PredictedPose predicted;
  double x = 0.0;
  for (int i = 0; i < 200; ++i) {
    x += i == 60 ? 0.3 : 0.01;
    history.add({i / k_rate_hz, {{x, 0.0, 0.0}, yaw(0.0)}});
    predictor.observe(history);
    predicted = predictor.predict(history, (i + 3) / k_rate_hz);
    if (i == 70) {
      EXPECT_GT(predicted.position_error_m, 0.2);
    }
  }
  EXPECT_LT(predicted.position_error_m, 0.05);
}

}  // namespace
}  // namespace sightline
