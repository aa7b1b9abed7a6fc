#include <cmath>
#include <limits>
#include <random>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/frustum.hpp"
#include "tests/client/client_scenes.hpp"

namespace sightline {
namespace {

using testing::view_pose;

/// Whether the point is inside a clip space of the given depth.
bool is_inside(const ViewPose& pose, ClipDepth depth, const glm::dvec3& point) {
  const glm::dvec4 clip = pose.clip_from_camera * pose.camera_from_world * glm::dvec4(point, 1.0);
  const double low = depth == ClipDepth::minus_one_to_one ? -clip.w : 0.0;
  return std::abs(clip.x) <= clip.w && std::abs(clip.y) <= clip.w && clip.z >= low && clip.z <= clip.w;
}

bool is_inside(const Eye& eye, const glm::dvec3& point) {
  return is_inside({ViewId{}, eye.camera_from_world, eye.clip_from_camera}, ClipDepth::minus_one_to_one,
                   point);
}

glm::dmat4 scaled(double x, double y, double z) {
  return glm::scale(glm::dmat4(1.0), {x, y, z});
}

/// The same view in a clip space with depths 0 to 1, or 1 to 0.
glm::dmat4 with_depth(glm::dmat4 clip, bool reversed) {
  for (int column = 0; column < 4; ++column) {
    const double z = clip[column][2], w = clip[column][3];
    clip[column][2] = 0.5 * (reversed ? w - z : w + z);
  }
  return clip;
}

/// That the wire's eye sees the same points, is one the daemon takes for an upright camera, and says which of
/// two points in line hides the other as the application's own depth does.
void expect_same_view(const ViewPose& pose, ClipDepth depth, bool upright = true) {
  const Eye eye = eye_of(pose, depth);
  if (upright) {
    EXPECT_TRUE(is_upright_perspective(eye.clip_from_camera));
  }
  EXPECT_LT(glm::determinant(eye.clip_from_camera), 0.0);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-60.0, 60.0);
  int inside = 0;
  for (int i = 0; i < 4000; ++i) {
    const glm::dvec3 point(place(random), place(random), place(random));
    EXPECT_EQ(is_inside(eye, point), is_inside(pose, depth, point));
    inside += is_inside(eye, point) ? 1 : 0;
  }
  EXPECT_GT(inside, 20);
  EXPECT_LT(inside, 2000);
}

TEST(ClientView, LeavesAnEyeOfTheWireAsItIs) {
  const ViewPose pose = view_pose(ViewId{}, {1, 2, 3}, 0.7);
  const Eye eye = eye_of(pose, ClipDepth::minus_one_to_one);
  EXPECT_EQ(eye.camera_from_world, pose.camera_from_world);
  EXPECT_EQ(eye.clip_from_camera, pose.clip_from_camera);
}

TEST(ClientView, SeesTheSameThroughAnyDepthAndHandedness) {
  const ViewPose gl = view_pose(ViewId{}, {1, 2, 3}, 0.7);
  expect_same_view(gl, ClipDepth::minus_one_to_one);
  ViewPose pose = gl;
  pose.clip_from_camera = with_depth(gl.clip_from_camera, false);
  expect_same_view(pose, ClipDepth::zero_to_one);
  pose.clip_from_camera = with_depth(gl.clip_from_camera, true);
  expect_same_view(pose, ClipDepth::zero_to_one);
  expect_same_view(pose, ClipDepth::one_to_zero);
  pose.clip_from_camera = scaled(1, -1, 1) * with_depth(gl.clip_from_camera, false);  // Vulkan
  expect_same_view(pose, ClipDepth::zero_to_one);
  pose = {ViewId{}, scaled(1, 1, -1) * gl.camera_from_world,
          with_depth(gl.clip_from_camera, false) * scaled(1, 1, -1)};  // Direct3D, left-handed
  expect_same_view(pose, ClipDepth::zero_to_one);
  pose = {ViewId{}, scaled(1, -1, -1) * gl.camera_from_world,
          gl.clip_from_camera * scaled(1, -1, -1)};  // looks along +Z with Y downwards
  expect_same_view(pose, ClipDepth::minus_one_to_one);
  pose = {ViewId{}, scaled(3, 3, 3) * gl.camera_from_world,
          gl.clip_from_camera * scaled(1.0 / 3, 1.0 / 3, 1.0 / 3)};
  expect_same_view(pose, ClipDepth::minus_one_to_one);
}

TEST(ClientView, SeesTheSameThroughAnInfiniteProjection) {
  ViewPose pose = view_pose(ViewId{}, {1, 2, 3}, 0.7);
  pose.clip_from_camera = glm::dmat4(0.0);
  pose.clip_from_camera[0][0] = 1.5;
  pose.clip_from_camera[1][1] = 2.0;
  pose.clip_from_camera[2][3] = -1.0;
  pose.clip_from_camera[3][2] = 0.1;  // reversed, 1 at the near plane to 0 at infinity
  expect_same_view(pose, ClipDepth::one_to_zero);
  expect_same_view(pose, ClipDepth::zero_to_one);
  const glm::dvec4 far_plane = frustum_of(eye_of(pose, ClipDepth::one_to_zero).clip_from_world()).planes[5];
  EXPECT_EQ(far_plane, glm::dvec4(0, 0, 0, 1));
}

TEST(ClientView, SeesAMirrorsViewFromBehindTheMirror) {
  const ViewPose straight = view_pose(ViewId{}, {1, 2, 3}, 0.7);
  ViewPose mirrored = straight;
  mirrored.camera_from_world = straight.camera_from_world * scaled(1, -1, 1);  // in the water at Y = 0
  expect_same_view(mirrored, ClipDepth::minus_one_to_one);
  const glm::dvec3 eye = position_of(eye_of(mirrored, ClipDepth::minus_one_to_one));
  EXPECT_NEAR(eye.y, -2.0, 1e-12);
}

TEST(ClientView, TellsNearFromFarInAParallelView) {
  const glm::dmat4 ortho = glm::orthoRH_NO(-20.0, 20.0, -15.0, 15.0, 1.0, 80.0);
  const ViewPose gl{ViewId{}, view_pose(ViewId{}, {1, 2, 3}, 0.7).camera_from_world, ortho};
  expect_same_view(gl, ClipDepth::minus_one_to_one, false);
  ViewPose left_handed{ViewId{}, scaled(1, 1, -1) * gl.camera_from_world,
                       with_depth(ortho, false) * scaled(1, 1, -1)};
  expect_same_view(left_handed, ClipDepth::zero_to_one, false);
  ViewPose reversed{ViewId{}, gl.camera_from_world, with_depth(ortho, true)};
  expect_same_view(reversed, ClipDepth::one_to_zero, false);
  for (const auto& [pose, depth] : {std::pair{gl, ClipDepth::minus_one_to_one},
                                    {left_handed, ClipDepth::zero_to_one},
                                    {reversed, ClipDepth::one_to_zero}}) {
    const glm::dmat4 clip_from_world = eye_of(pose, depth).clip_from_world();
    const glm::dmat4 world_from_camera = glm::inverse(gl.camera_from_world);
    const double near_depth = (clip_from_world * (world_from_camera * glm::dvec4(0, 0, -2, 1))).z;
    const double far_depth = (clip_from_world * (world_from_camera * glm::dvec4(0, 0, -70, 1))).z;
    EXPECT_LT(near_depth, far_depth);
  }
}

TEST(ClientView, RefusesWhatIsNoView) {
  const ViewPose good = view_pose(ViewId{3}, {1, 2, 3}, 0.7);
  const auto refuses = [](const ViewPose& pose) {
    try {
      (void)eye_of(pose, ClipDepth::minus_one_to_one);
    } catch (const InputError& error) {
      return std::string(error.what()).starts_with("view 3: ");
    }
    return false;
  };
  ViewPose bad = good;
  bad.camera_from_world[1][2] = std::nan("");
  EXPECT_TRUE(refuses(bad));
  bad = good;
  bad.clip_from_camera[0][0] = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(refuses(bad));
  bad = good;
  bad.clip_from_camera = glm::dmat4(0.0);
  EXPECT_TRUE(refuses(bad));
  bad = good;
  bad.camera_from_world = glm::dmat4(0.0);
  EXPECT_TRUE(refuses(bad));
  bad = good;
  bad.camera_from_world[0][1] += 0.5;  // skewed
  EXPECT_TRUE(refuses(bad));
  bad = good;
  bad.camera_from_world[0][3] = 0.5;
  EXPECT_TRUE(refuses(bad));
  bad = good;
  bad.camera_from_world = scaled(1, 2, 1) * good.camera_from_world;
  EXPECT_TRUE(refuses(bad));
}

}  // namespace
}  // namespace sightline
