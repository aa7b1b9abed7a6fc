#include "main_view/app/fly_camera.hpp"

#include <gtest/gtest.h>

namespace sightline {
namespace {

glm::dvec3 forward_of(const Pose& pose) {
  return pose.world_from_camera * glm::dvec3(0, 0, -1);
}

TEST(FlyCamera, KeepsAPosesPlaceAndDirection) {
  FlyCamera camera;
  camera.move(3.0, 2.0, 1.0);
  camera.turn(0.7, -0.4);
  const Pose pose = camera.pose();
  const Pose again = FlyCamera(pose).pose();
  EXPECT_LT(glm::length(again.position_m - pose.position_m), 1e-12);
  EXPECT_LT(rotation_angle_rad(again.world_from_camera, pose.world_from_camera), 1e-6);
}

TEST(FlyCamera, MovesWhereItLooks) {
  FlyCamera camera;
  camera.turn(1.2, 0.3);
  const glm::dvec3 before = camera.pose().position_m;
  camera.move(0.0, 0.0, 2.0);
  EXPECT_LT(glm::length(camera.pose().position_m - before - 2.0 * forward_of(camera.pose())), 1e-12);
}

TEST(FlyCamera, NeverTurnsOverItsHead) {
  FlyCamera camera;
  camera.turn(0.0, 100.0);
  EXPECT_GT(forward_of(camera.pose()).y, 0.99);
  EXPECT_GT((camera.pose().world_from_camera * glm::dvec3(0, 1, 0)).y, 0.0);
  camera.turn(0.0, -200.0);
  EXPECT_LT(forward_of(camera.pose()).y, -0.99);
  EXPECT_GT((camera.pose().world_from_camera * glm::dvec3(0, 1, 0)).y, 0.0);
}

TEST(FlyCamera, OverviewHasTheWholeBoxAhead) {
  Aabb box;
  box.add(glm::vec3(-10, 0, -20));
  box.add(glm::vec3(30, 5, 40));
  const Pose pose = overview_of(box, {1000.0, 0.0, 0.0});
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 corner((i & 1) ? 1030 : 990, (i & 2) ? 5 : 0, (i & 4) ? 40 : -20);
    EXPECT_GT(glm::dot(corner - pose.position_m, forward_of(pose)), 0.0) << i;
  }
}

}  // namespace
}  // namespace sightline
