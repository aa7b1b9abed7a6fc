#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "common/camera_path.hpp"
#include "common/error.hpp"
#include "common/statistics.hpp"
#include "main_view/client/motion_predictor.hpp"
#include "tests/client/predictor_options.hpp"
#include "tests/common/test_scenes.hpp"

namespace sightline {
namespace {

using testing::fixed_predictor;

constexpr double k_rate_hz = 60.0;
constexpr double k_step_s = 1.0 / k_rate_hz;

glm::dquat turned(double angle_rad, const glm::dvec3& axis = {0.0, 1.0, 0.0}) {
  return glm::angleAxis(angle_rad, glm::normalize(axis));
}

CullingOptions adaptive_options() {
  CullingOptions options;
  options.predictor = PredictorKind::adaptive;
  return options;
}

/// A client's use: every pose is filed and observed, then something is asked.
struct Session {
  explicit Session(const CullingOptions& options = adaptive_options())
      : history(options), predictor(options) {}

  PoseHistory::Added add(const TimedPose& sample) {
    const auto added = history.add(sample);
    if (added == PoseHistory::Added::jumped || added == PoseHistory::Added::restarted)
      predictor.forget_pending();
    predictor.observe(history);
    return added;
  }
  PredictedPose ahead(double lead_s) { return predictor.predict(history, history.newest().time_s + lead_s); }

  PoseHistory history;
  MotionPredictor predictor;
};

struct Errors {
  double position_m = 0.0;  ///< means
  double rotation_rad = 0.0;
  double coverage = 0.0;
  double region_m = 0.0;
  double high_m = 0.0;  ///< what 99.5 % of the position's errors stay below
};

/// Predicts `frames` ahead along `samples`, which are one step apart, from `first` on.
Errors errors_on(const std::vector<TimedPose>& samples, std::size_t frames,
                 const CullingOptions& options = adaptive_options(), std::size_t first = 60) {
  Session session(options);
  Errors sum;
  double count = 0.0;
  std::vector<double> all_m;
  for (std::size_t i = 0; i + frames < samples.size(); ++i) {
    session.add(samples[i]);
    const Pose& truth = samples[i + frames].pose;
    const PredictedPose predicted = session.predictor.predict(session.history, samples[i + frames].time_s);
    if (i < first) continue;
    const double off_m = glm::length(predicted.pose.position_m - truth.position_m);
    const double off_rad = rotation_angle_rad(predicted.pose.world_from_camera, truth.world_from_camera);
    sum.position_m += off_m;
    all_m.push_back(off_m);
    sum.rotation_rad += off_rad;
    sum.coverage +=
        off_m <= predicted.position_error_m + 1e-9 && off_rad <= predicted.rotation_error_rad + 1e-7;
    sum.region_m += predicted.position_error_m;
    count += 1.0;
  }
  return {sum.position_m / count, sum.rotation_rad / count, sum.coverage / count, sum.region_m / count,
          quantile_of(all_m, 0.995)};
}

std::vector<TimedPose> sampled(const std::function<Pose(double)>& motion, double seconds) {
  std::vector<TimedPose> samples;
  samples.reserve(static_cast<std::size_t>(seconds * k_rate_hz) + 1);
  for (int i = 0; i < seconds * k_rate_hz; ++i) samples.push_back({i * k_step_s, motion(i * k_step_s)});
  return samples;
}

/// A head: it looks about and sways, with smooth random speeds.
std::vector<TimedPose> random_head(unsigned seed, double seconds, double noise_m = 0.0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  glm::dvec3 position(0.0), velocity(0.0), turn_speed(0.0), pull(0.0), twist(0.0);
  glm::dquat rotation(1.0, 0.0, 0.0, 0.0);
  std::vector<TimedPose> samples;
  for (int i = 0; i < seconds * k_rate_hz; ++i) {
    if (random() % 20 == 0) pull = 2.0 * glm::dvec3(normal(random), normal(random), normal(random));
    if (random() % 20 == 0) twist = 8.0 * glm::dvec3(normal(random), normal(random), normal(random));
    velocity += k_step_s * (pull - 2.0 * velocity - position);
    turn_speed += k_step_s * (twist - 3.0 * turn_speed);
    position += k_step_s * velocity;
    const double speed = glm::length(turn_speed);
    if (speed > 1e-9) rotation = glm::normalize(rotation * turned(speed * k_step_s, turn_speed));
    const glm::dvec3 noise = noise_m * glm::dvec3(normal(random), normal(random), normal(random));
    samples.push_back({i * k_step_s, {position + noise, rotation}});
  }
  return samples;
}

TEST(AdaptivePredictor, PredictsASteadyMoveAndTurnExactlyFromTheSecondPoseOn) {
  Session session;
  const auto at = [](double t) {
    return Pose{{2e6 + 1.4 * t, 1.7, -3.0 * t}, turned(1.3 * t, {0.3, 1.0, 0.2})};
  };
  for (int i = 0; i < 120; ++i) {
    session.add({i * k_step_s, at(i * k_step_s)});
    if (i == 0) continue;
    for (const double lead_s : {0.01, k_step_s, 0.083, 0.4}) {
      const PredictedPose predicted = session.ahead(lead_s);
      const Pose truth = at(i * k_step_s + lead_s);
      EXPECT_LT(glm::length(predicted.pose.position_m - truth.position_m), 1e-5) << i << ", " << lead_s;
      EXPECT_LT(rotation_angle_rad(predicted.pose.world_from_camera, truth.world_from_camera), 1e-6);
    }
  }
}

TEST(AdaptivePredictor, LearnsToFollowASteadyAcceleration) {
  const auto samples = sampled(
      [](double t) {
        return Pose{{0.5 * 3.0 * t * t, 0.0, 0.0}, turned(0.2 * t * t)};
      },
      6.0);
  const Errors adaptive = errors_on(samples, 10, adaptive_options(), 240);
  const Errors steady = errors_on(samples, 10, fixed_predictor(1, 2), 240);
  EXPECT_LT(adaptive.position_m, 0.1 * steady.position_m);
  EXPECT_LT(adaptive.rotation_rad, 0.1 * steady.rotation_rad);
}

TEST(AdaptivePredictor, KeepsAStillHeadWithNoiseWhereItIs) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  std::vector<TimedPose> samples;
  for (int i = 0; i < 2400; ++i) {
    const glm::dvec3 noise(normal(random), normal(random), normal(random));
    samples.push_back({i * k_step_s, {{1e-3 * noise}, turned(1e-3 * normal(random), {1.0, 1.0, 0.0})}});
  }
  // Two noises, of here and there, are sqrt(2) times 1.6 mm in the mean.
  for (const std::size_t frames : {1u, 5u, 20u}) {
    const Errors errors = errors_on(samples, frames, adaptive_options(), 1200);
    EXPECT_LT(errors.position_m, 0.0023 * 1.1) << frames;
    EXPECT_GT(errors_on(samples, frames, fixed_predictor(1, 2), 1200).position_m, errors.position_m);
    EXPECT_GE(errors.coverage, 0.99);
    EXPECT_LT(errors.region_m, 0.03);  // the most far ahead: it may begin to move
  }
}

TEST(AdaptivePredictor, KeepsAStillCameraToTheBitAndAnnouncesWhatItMayDo) {
  Session session;
  const Pose pose{{0.1, 1.7, -1e6 / 3.0}, {0.8839912, 0.0742901, 0.4599417, -0.0386532}};
  for (int i = 0; i < 60; ++i) {
    session.add({i * k_step_s, pose});
    EXPECT_EQ(session.ahead(0.1).pose, pose);
    EXPECT_EQ(session.ahead(0.1).position_error_m, 0.0);
  }
  // One that has moved may move again.
  for (int i = 60; i < 120; ++i) {
    Pose moved = pose;
    moved.position_m.x += 0.2 * std::sin(6.0 * i * k_step_s);
    session.add({i * k_step_s, moved});
  }
  const Pose last = session.history.newest().pose;
  for (int i = 120; i < 150; ++i) session.add({i * k_step_s, last});
  EXPECT_EQ(session.ahead(0.1).pose, last);
  EXPECT_GT(session.ahead(0.1).position_error_m, 0.005);
}

TEST(AdaptivePredictor, GivesTheNewestPoseItselfAtHorizonZero) {
  Session session;
  for (const TimedPose& sample : random_head(1, 1.0)) session.add(sample);
  for (const double lead_s : {0.0, -1.0, std::nan("")}) {
    EXPECT_EQ(session.ahead(lead_s).pose, session.history.newest().pose);
    EXPECT_EQ(session.ahead(lead_s).rotation_error_rad, 0.0);
  }
}

TEST(AdaptivePredictor, IsNotHarmedByFlippedQuaternionSigns) {
  Session plain;
  Session flipped;
  std::mt19937 random(3);
  for (const TimedPose& sample : random_head(2, 4.0)) {
    plain.add(sample);
    TimedPose other = sample;
    if (random() % 2 == 0) other.pose.world_from_camera = -other.pose.world_from_camera;
    flipped.add(other);
    EXPECT_LT(rotation_angle_rad(plain.ahead(0.1).pose.world_from_camera,
                                 flipped.ahead(0.1).pose.world_from_camera),
              1e-6);
    EXPECT_NEAR(plain.ahead(0.1).rotation_error_rad, flipped.ahead(0.1).rotation_error_rad, 1e-6);
  }
}

TEST(AdaptivePredictor, IgnoresASingleStrayPoseAndReachesOutToIt) {
  Session session;
  const auto at = [](double t) { return Pose{{0.5 * t, 1.7, 0.0}, turned(0.5 * t)}; };
  for (int i = 0; i < 120; ++i) {
    Pose pose = at(i * k_step_s);
    if (i == 90) {
      pose.position_m.y += 0.3;
      pose.world_from_camera = pose.world_from_camera * turned(0.3);
    }
    session.add({i * k_step_s, pose});
    if (i < 2) continue;
    const PredictedPose predicted = session.ahead(0.1);
    const Pose truth = at(i * k_step_s + 0.1);
    EXPECT_LT(glm::length(predicted.pose.position_m - truth.position_m), 1e-6) << i;
    EXPECT_LT(rotation_angle_rad(predicted.pose.world_from_camera, truth.world_from_camera), 1e-6) << i;
    if (i == 90) {
      EXPECT_GT(predicted.position_error_m, 0.29);
      EXPECT_GT(predicted.rotation_error_rad, 0.25);
    }
  }
}

TEST(AdaptivePredictor, GoesOnFromWhereAStepLeads) {
  // Too short for PoseHistory to call it a jump, too far to be motion.
  Session session;
  for (int i = 0; i < 120; ++i) {
    const double x_m = 0.5 * i * k_step_s + (i >= 90 ? 0.4 : 0.0);
    EXPECT_NE(session.add({i * k_step_s, {{x_m, 1.7, 0.0}, turned(0.0)}}), PoseHistory::Added::jumped);
    if (i < 2 || i == 90) continue;
    EXPECT_NEAR(session.ahead(0.1).pose.position_m.x, x_m + 0.05, 1e-6) << i;
  }
}

TEST(AdaptivePredictor, StartsAnewAfterAJumpAndAfterAPauseWithWhatItLearnt) {
  const auto head = random_head(5, 20.0);
  for (const bool jumps : {true, false}) {
    Session session;
    Errors after;
    int count = 0;
    for (std::size_t i = 0; i + 5 < head.size(); ++i) {
      const bool later = i >= 900;
      const double pause_s = later && !jumps ? 3.0 : 0.0;
      const glm::dvec3 away(later && jumps ? 100.0 : 0.0, 0.0, 0.0);
      const auto added = session.add(
          {head[i].time_s + pause_s, {head[i].pose.position_m + away, head[i].pose.world_from_camera}});
      if (i == 900) {
        EXPECT_EQ(added, jumps ? PoseHistory::Added::jumped : PoseHistory::Added::restarted);
        EXPECT_LT(glm::length(session.ahead(0.08).pose.position_m - away - head[i].pose.position_m), 1e-9);
        EXPECT_GT(session.ahead(0.08).position_error_m, 0.0);
      }
      if (i < 903 || i > 960) continue;
      after.position_m +=
          glm::length(session.ahead(5 * k_step_s).pose.position_m - away - head[i + 5].pose.position_m);
      ++count;
    }
    const Errors whole = errors_on(head, 5);
    EXPECT_LT(after.position_m / count, 4.0 * whole.position_m);
  }
}

TEST(AdaptivePredictor, BearsDroppedSamplesAndUnevenRates) {
  const auto at = [](double t) {
    return Pose{{0.3 * std::sin(2.0 * t), 1.7, 0.2 * std::cos(3.0 * t)}, turned(0.6 * std::sin(1.5 * t))};
  };
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Session session;
  double time_s = 0.0;
  double worst_m = 0.0;
  double worst_rad = 0.0;
  while (time_s < 20.0) {
    time_s += uniform(random) < 0.1 ? 0.05 : 0.004 + 0.02 * uniform(random);
    session.add({time_s, at(time_s)});
    if (time_s < 5.0) continue;
    const PredictedPose predicted = session.ahead(0.08);
    const Pose truth = at(time_s + 0.08);
    worst_m = std::max(worst_m, glm::length(predicted.pose.position_m - truth.position_m));
    worst_rad =
        std::max(worst_rad, rotation_angle_rad(predicted.pose.world_from_camera, truth.world_from_camera));
  }
  // The accelerations are up to 2.2 m/s^2 and 1.35 rad/s^2: 7 mm and 4.3 mrad for who knows only the speed.
  EXPECT_LT(worst_m, 0.006);
  EXPECT_LT(worst_rad, 0.003);
}

TEST(AdaptivePredictor, TakesAPoseOfTheSameTimeInPlaceOfTheOneBefore) {
  Session replaced;
  Session plain;
  for (int i = 0; i < 60; ++i) {
    const TimedPose sample{i * k_step_s, {{0.01 * i, 0.0, 0.0}, turned(0.0)}};
    replaced.add({sample.time_s, {{0.01 * i, 0.02, 0.0}, turned(0.01)}});
    replaced.add(sample);
    plain.add(sample);
  }
  EXPECT_NEAR(replaced.ahead(0.1).pose.position_m.x, plain.ahead(0.1).pose.position_m.x, 0.01);
  EXPECT_NEAR(replaced.ahead(0.1).pose.position_m.y, 0.0, 0.01);
}

TEST(AdaptivePredictor, IsUnmovedByATimeThatGoesBackAndByPosesThatAreNotFinite) {
  Session session;
  for (const TimedPose& sample : random_head(7, 3.0)) session.add(sample);
  const Pose before = session.ahead(0.1).pose;
  EXPECT_EQ(session.add({1.0, {{50.0, 0.0, 0.0}, turned(1.0)}}), PoseHistory::Added::ignored);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(session.add({4.0, {{nan, 0.0, 0.0}, turned(1.0)}}), InputError);
  EXPECT_EQ(session.ahead(0.1).pose, before);
}

TEST(AdaptivePredictor, StaysFiniteWhateverThePosesAre) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Session session;
  double time_s = 0.0;
  for (int i = 0; i < 3000; ++i) {
    time_s += std::pow(10.0, -6.0 + 5.5 * std::abs(uniform(random)));
    const double size_m = std::pow(10.0, 6.0 * uniform(random));
    session.add({time_s,
                 {size_m * glm::dvec3(uniform(random), uniform(random), uniform(random)),
                  glm::normalize(glm::dquat(uniform(random), uniform(random), uniform(random), 1.01))}});
    for (const double lead_s : {1e-9, 0.05, 0.5, 10.0, 1e6}) {
      const PredictedPose predicted = session.ahead(lead_s);
      ASSERT_TRUE(std::isfinite(glm::length(predicted.pose.position_m))) << i << ", " << lead_s;
      ASSERT_NEAR(glm::length(predicted.pose.world_from_camera), 1.0, 1e-9);
      ASSERT_TRUE(std::isfinite(predicted.position_error_m));
      ASSERT_GE(predicted.position_error_m, 0.0);
      ASSERT_GE(predicted.rotation_error_rad, 0.0);
      ASSERT_LE(predicted.rotation_error_rad, 3.1416);
    }
  }
}

TEST(AdaptivePredictor, AnnouncesARegionThatHoldsTheTruthAndIsNoLargerThanItNeed) {
  for (const std::size_t frames : {1u, 5u, 20u}) {
    double coverage = 0.0;
    double size = 0.0;
    constexpr unsigned k_heads = 6;
    for (unsigned seed = 0; seed < k_heads; ++seed) {
      const auto head = random_head(10 + seed, 40.0, seed % 2 == 0 ? 0.0 : 1e-3);
      const Errors errors = errors_on(head, frames, adaptive_options(), 20);
      coverage += errors.coverage / k_heads;
      size += errors.region_m / errors.high_m / k_heads;
    }
    // One surprise is as long as the lead: of 40 s, a third of a second is most of a percent.
    EXPECT_GE(coverage, frames < 20 ? 0.995 : 0.99) << frames;
    EXPECT_LT(size, 4.0) << frames;
    EXPECT_GT(size, 0.5) << frames;
  }
}

TEST(AdaptivePredictor, BeatsEachFixedChoiceOnAMixtureOfMotions) {
  // Ten seconds each of noise at rest, a smooth flight and a jerky head, twice over.
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  const auto jerky = random_head(17, 60.0);
  std::vector<TimedPose> mixture;
  for (int i = 0; i < 60 * 60; ++i) {
    const double t = i * k_step_s;
    const int part = static_cast<int>(t / 10.0) % 3;
    Pose pose = jerky[static_cast<std::size_t>(i)].pose;
    if (part == 0)
      pose = {1e-3 * glm::dvec3(normal(random), normal(random), normal(random)),
              turned(1e-3 * normal(random))};
    if (part == 1) pose = {{std::sin(t), 0.0, std::cos(0.7 * t)}, turned(std::sin(0.9 * t))};
    mixture.push_back({t, pose});
  }
  for (const std::size_t frames : {5u, 10u, 20u}) {
    const Errors adaptive = errors_on(mixture, frames);
    for (const auto& [order, window] : {std::pair{0, 1}, {1, 2}, {1, 5}, {2, 3}, {2, 8}, {2, 20}}) {
      const Errors errors = errors_on(mixture, frames, fixed_predictor(order, window));
      EXPECT_LT(adaptive.position_m, errors.position_m) << frames << ": " << order << " over " << window;
      EXPECT_LT(adaptive.rotation_rad, errors.rotation_rad) << frames << ": " << order << " over " << window;
    }
  }
}

TEST(AdaptivePredictor, BeatsTheFixedOnesOnRecordedMotionAndHoldsItInItsRegion) {
  const auto shared = testing::shared_folder();
  if (!shared) GTEST_SKIP() << "no ../shared/traces here: recorded motion is not checked";
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(*shared / "traces"))
    if (entry.path().extension() == ".csv") files.push_back(entry.path());
  ASSERT_FALSE(files.empty());
  double against_hold = 0.0;
  double against_velocity = 0.0;
  double turn_against_velocity = 0.0;
  constexpr std::size_t k_frames = 5;
  for (const auto& file : files) {
    const CameraPath trace = read_camera_path(file);
    // The longest stretch without a pause.
    std::size_t begin = 0, best_begin = 0, best_end = 0;
    for (std::size_t i = 1; i <= trace.samples.size(); ++i) {
      if (i < trace.samples.size() && trace.samples[i].time_s - trace.samples[i - 1].time_s <= 0.1) continue;
      if (i - begin > best_end - best_begin) best_begin = begin, best_end = i;
      begin = i;
    }
    std::vector<TimedPose> samples;
    const double from_s = trace.samples[best_begin].time_s;
    for (int i = 0; from_s + i * k_step_s <= trace.samples[best_end - 1].time_s; ++i)
      samples.push_back({i * k_step_s, trace.at(from_s + i * k_step_s)});
    const Errors adaptive = errors_on(samples, k_frames, adaptive_options(), 20);
    const Errors velocity = errors_on(samples, k_frames, fixed_predictor(1, 2), 20);
    against_hold +=
        std::log(adaptive.position_m / errors_on(samples, k_frames, fixed_predictor(0, 1), 20).position_m);
    against_velocity += std::log(adaptive.position_m / velocity.position_m);
    turn_against_velocity += std::log(adaptive.rotation_rad / velocity.rotation_rad);
    EXPECT_GE(adaptive.coverage, 0.995) << file;
  }
  const double count = static_cast<double>(files.size());
  EXPECT_LT(std::exp(against_hold / count), 0.2);
  EXPECT_LT(std::exp(against_velocity / count), 0.8);
  EXPECT_LT(std::exp(turn_against_velocity / count), 0.9);
}

}  // namespace
}  // namespace sightline
