#include <cmath>
#include <random>

#include <glm/gtc/matrix_access.hpp>
#include <gtest/gtest.h>

#include "common/pose.hpp"
#include "common/view.hpp"

namespace sightline {
namespace {

glm::dquat random_rotation(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random)));
}

TEST(Pose, LooksDownMinusZWithYUp) {
  const Pose pose{{1, 2, 3}, {1, 0, 0, 0}};
  const glm::dvec4 ahead = camera_from_world(pose) * glm::dvec4(1, 2, -7, 1);
  EXPECT_EQ(ahead, glm::dvec4(0, 0, -10, 1));
}

TEST(Pose, ComesBackFromItsMatrix) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 1000; ++i) {
    const Pose pose{{1e6 * i, -3.0 * i, 0.5}, random_rotation(random)};
    const Pose again = pose_of(camera_from_world(pose));
    EXPECT_LT(glm::distance(pose.position_m, again.position_m), 1e-5);
    EXPECT_LT(rotation_angle_rad(pose.world_from_camera, again.world_from_camera), 1e-12);
  }
}

TEST(Pose, MeasuresTinyAndHalfTurnsAlike) {
  const glm::dquat still(1, 0, 0, 0);
  for (const double angle : {1e-12, 1e-6, 0.1, 3.0, 3.14159}) {
    const glm::dquat turned = glm::angleAxis(angle, glm::dvec3(0, 1, 0));
    EXPECT_NEAR(rotation_angle_rad(still, turned) / angle, 1.0, 1e-9);
    EXPECT_NEAR(rotation_angle_rad(still, -turned) / angle, 1.0, 1e-9);
  }
}

TEST(ImageSizeText, IsReadStrictly) {
  EXPECT_EQ(parse_image_size("512x384"), (ImageSize{512, 384}));
  EXPECT_EQ(parse_image_size("16384x1"), (ImageSize{16384, 1}));
  for (const char* text : {"", "x", "512", "512x", "x384", "0x384", "512x0", "16385x1", "1x1000000", "-1x5",
                           "5x5 ", "5 x5", "5X5", "99999999999x1", "1x1x1", "1.5x2", "+1x1"}) {
    EXPECT_FALSE(parse_image_size(text)) << text;
  }
}

TEST(Widened, HoldsEverythingATurnedCameraSees) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int outside_unwidened = 0;
  for (int i = 0; i < 20000; ++i) {
    Perspective perspective;
    perspective.vertical_fov_rad = 0.7 + 0.4 * unit(random);
    glm::dmat4 clip = clip_from_camera(perspective, 1.3 + unit(random));
    clip[2][0] = 0.3 * unit(random);  // off-axis, as an eye of a headset is
    clip[2][1] = 0.3 * unit(random);
    const double angle = 0.2 + 0.2 * unit(random);
    const glm::dmat4 wide = widened(clip, angle);
    const glm::dvec3 axis(unit(random), unit(random), unit(random));
    const glm::dmat3 turn = glm::mat3_cast(glm::angleAxis(angle, glm::normalize(axis)));
    // A point that the turned camera sees, at its edges more often than not.
    const auto edge = [&] { return std::clamp(1.5 * unit(random), -1.0, 1.0); };
    const glm::dvec4 clip_point(edge(), edge(), edge(), 1.0);
    const glm::dvec4 seen = glm::inverse(clip) * clip_point;
    const glm::dvec4 camera(turn * (glm::dvec3(seen) / seen.w), 1.0);
    const glm::dvec4 in_wide = wide * camera;
    // Beyond 80 degrees the promise ends.
    if (std::abs(camera.x) > 5.0 * -camera.z || std::abs(camera.y) > 5.0 * -camera.z) continue;
    const double slack = 1e-9 * in_wide.w;
    EXPECT_LE(std::abs(in_wide.x), in_wide.w + slack);
    EXPECT_LE(std::abs(in_wide.y), in_wide.w + slack);
    const glm::dvec4 in_narrow = clip * camera;
    if (std::abs(in_narrow.x) > in_narrow.w || std::abs(in_narrow.y) > in_narrow.w) ++outside_unwidened;
  }
  EXPECT_GT(outside_unwidened, 1000);  // otherwise the above shows nothing
}

TEST(Widened, KeepsTheDepthOfWhatATurnedCameraSees) {
  const Perspective perspective;
  const glm::dmat4 clip = clip_from_camera(perspective, 1.5);
  const glm::dmat4 wide = widened(clip, 0.25);
  for (const double yaw : {-0.25, 0.25}) {
    const glm::dmat3 turn = glm::mat3_cast(glm::angleAxis(yaw, glm::dvec3(0, 1, 0)));
    for (const double x : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) {
        const glm::dvec4 seen = glm::inverse(clip) * glm::dvec4(x, 1.0, z, 1.0);
        const glm::dvec4 in_wide = wide * glm::dvec4(turn * (glm::dvec3(seen) / seen.w), 1.0);
        EXPECT_LE(std::abs(in_wide.z), in_wide.w * (1 + 1e-9));
      }
    }
  }
}

TEST(Widened, IsTightForATurnOfTheFieldsOwnAxes) {
  const glm::dmat4 clip = clip_from_camera({}, 1.0);
  const glm::dmat4 wide = widened(clip, 0.1);
  const double half = std::atan(1.0 / clip[0][0]);
  const double wide_half = std::atan(1.0 / wide[0][0]);
  EXPECT_GE(wide_half, half + 0.1);
  EXPECT_LT(wide_half, half + 0.12);
}

TEST(Widened, LeavesWhatItDoesNotKnowAsItIs) {
  const glm::dmat4 orthographic(1.0);
  EXPECT_EQ(widened(orthographic, 0.2), orthographic);
  const glm::dmat4 clip = clip_from_camera({}, 1.0);
  EXPECT_EQ(widened(clip, 0.0), clip);
  EXPECT_EQ(widened(clip, -1.0), clip);
  EXPECT_EQ(widened(clip, std::nan("")), clip);
}

TEST(Widened, StopsAtEightyDegrees) {
  const glm::dmat4 wide = widened(clip_from_camera({}, 1.0), 2.0);
  EXPECT_NEAR(std::atan(1.0 / wide[0][0]), 80.0 * M_PI / 180.0, 1e-9);
}

TEST(StereoEyes, LieApartAlongTheHeadsX) {
  const Pose head{{1, 2, 3}, glm::angleAxis(M_PI / 2, glm::dvec3(0, 1, 0))};
  const StereoEyes eyes = stereo_eyes(head, 0.064);
  EXPECT_LT(glm::distance(eyes.right.position_m, glm::dvec3(1, 2, 3 - 0.032)), 1e-12);
  EXPECT_LT(glm::distance(eyes.left.position_m, glm::dvec3(1, 2, 3 + 0.032)), 1e-12);
  EXPECT_EQ(eyes.left.world_from_camera, head.world_from_camera);
}

}  // namespace
}  // namespace sightline
