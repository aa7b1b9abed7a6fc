// What a program's matrices mean: however they are written, the same eye.

#include "main_view/client/c_api/view_matrices.hpp"

#include <array>
#include <cmath>
#include <random>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <gtest/gtest.h>

#include "main_view/client/c_api/failure.hpp"

namespace sightline::c_api {
namespace {

using Numbers = std::array<double, 16>;

Numbers numbers_of(const glm::dmat4& matrix, bool row_major = false) {
  const glm::dmat4 written = row_major ? glm::transpose(matrix) : matrix;
  Numbers numbers{};
  std::copy(glm::value_ptr(written), glm::value_ptr(written) + 16, numbers.begin());
  return numbers;
}

Eye eye(const MatrixConvention& convention, const glm::dmat4& view, const glm::dmat4& projection) {
  const Numbers first = numbers_of(view, convention.row_major);
  const Numbers second = numbers_of(projection, convention.row_major);
  return eye_of(convention, first, second);
}

const glm::dmat4 k_view = glm::lookAtRH(glm::dvec3(3, 2, 5), glm::dvec3(-1, 1, -4), glm::dvec3(0, 1, 0));
constexpr double k_near_m = 0.25, k_far_m = 64.0;

/// x, y and w of a clip point say where in the image it is, z and w whether a plane cuts it.
bool is_inside(const glm::dvec4& clip) {
  return clip.w > 0.0 && std::abs(clip.x) <= clip.w && std::abs(clip.y) <= clip.w &&
         std::abs(clip.z) <= clip.w;
}

/// Expects `eye` to show the points that `expected` shows: no others, and at the same place but for mirrors.
void expect_same_view(const Eye& eye, const glm::dmat4& expected) {
  const glm::dmat3 rotation(eye.camera_from_world);
  EXPECT_NEAR(glm::determinant(rotation), 1.0, 1e-9) << "a rotation, not a mirror";
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(-30.0, 30.0);
  int inside = 0;
  for (int i = 0; i < 4000; ++i) {
    const glm::dvec4 point(coordinate(random), 0.3 * coordinate(random), coordinate(random), 1.0);
    const glm::dvec4 is = eye.clip_from_world() * point, should = expected * point;
    ASSERT_EQ(is_inside(is), is_inside(should)) << point.x << " " << point.y << " " << point.z;
    if (!is_inside(should)) continue;
    ++inside;
    ASSERT_NEAR(std::abs(is.x / is.w), std::abs(should.x / should.w), 1e-9);
    ASSERT_NEAR(std::abs(is.y / is.w), std::abs(should.y / should.w), 1e-9);
    ASSERT_NEAR(is.z / is.w, should.z / should.w, 1e-9) << "near is -1, far is 1";
  }
  EXPECT_GT(inside, 20);
}

glm::dmat4 opengl() {
  return glm::perspectiveRH_NO(1.0, 1.5, k_near_m, k_far_m);
}

TEST(CMatrices, OfOpenGLStayAsTheyAre) {
  const Eye same = eye({}, k_view, opengl());
  EXPECT_EQ(same.camera_from_world, k_view);
  EXPECT_EQ(same.clip_from_camera, opengl());
}

TEST(CMatrices, MayBeRowMajorWithDepthFromZeroToOneAndReversed) {
  const glm::dmat4 expected = opengl() * k_view;
  const glm::dmat4 zero_to_one = glm::perspectiveRH_ZO(1.0, 1.5, k_near_m, k_far_m);
  const glm::dmat4 reversed_zero_to_one = glm::perspectiveRH_ZO(1.0, 1.5, k_far_m, k_near_m);
  const glm::dmat4 reversed = glm::perspectiveRH_NO(1.0, 1.5, k_far_m, k_near_m);
  for (const bool rows : {false, true}) {
    expect_same_view(eye({rows, false, false}, k_view, opengl()), expected);
    expect_same_view(eye({rows, true, false}, k_view, zero_to_one), expected);
    expect_same_view(eye({rows, true, true}, k_view, reversed_zero_to_one), expected);
    expect_same_view(eye({rows, false, true}, k_view, reversed), expected);
  }
}

TEST(CMatrices, MayBeParallelInEveryConvention) {
  const glm::dmat4 expected = glm::orthoRH_NO(-9.0, 12.0, -5.0, 6.0, k_near_m, k_far_m) * k_view;
  expect_same_view(eye({}, k_view, glm::orthoRH_NO(-9.0, 12.0, -5.0, 6.0, k_near_m, k_far_m)), expected);
  expect_same_view(
      eye({false, true, false}, k_view, glm::orthoRH_ZO(-9.0, 12.0, -5.0, 6.0, k_near_m, k_far_m)), expected);
  expect_same_view(
      eye({false, true, true}, k_view, glm::orthoRH_ZO(-9.0, 12.0, -5.0, 6.0, k_far_m, k_near_m)), expected);
  expect_same_view(
      eye({false, false, true}, k_view, glm::orthoRH_NO(-9.0, 12.0, -5.0, 6.0, k_far_m, k_near_m)), expected);
}

TEST(CMatrices, MayBeOffAxis) {
  const glm::dmat4 projection = glm::frustumRH_NO(-0.1, 0.4, -0.3, 0.1, k_near_m, k_far_m);
  expect_same_view(eye({}, k_view, projection), projection * k_view);
  expect_same_view(
      eye({false, true, false}, k_view, glm::frustumRH_ZO(-0.1, 0.4, -0.3, 0.1, k_near_m, k_far_m)),
      projection * k_view);
}

TEST(CMatrices, MayHaveNoFarPlaneOrOneBeyondInfinity) {
  const glm::dmat4 infinite = glm::infinitePerspectiveRH(1.0, 1.5, k_near_m);
  const glm::dmat4 expected = infinite * k_view;
  expect_same_view(eye({}, k_view, infinite), expected);
  // Reversed, 0 to 1, infinite: what modern engines use. Depth is near / distance.
  glm::dmat4 reversed = infinite;
  reversed[2][2] = 0.0;
  reversed[3][2] = k_near_m;
  expect_same_view(eye({false, true, true}, k_view, reversed), expected);
  // As an epsilon against rounding leaves it: everything farther than the near plane is before the far one.
  glm::dmat4 beyond = infinite;
  beyond[2][2] += 1e-7;
  beyond[3][2] = k_near_m * (beyond[2][2] - 1.0);
  const Eye settled = eye({}, k_view, beyond);
  EXPECT_EQ(settled.clip_from_camera[2][2], -1.0);
  expect_same_view(settled, expected);
}

TEST(CMatrices, MayLookAlongPositiveZInALeftHandedWorld) {
  const glm::dmat4 view = glm::lookAtLH(glm::dvec3(3, 2, 5), glm::dvec3(-1, 1, -4), glm::dvec3(0, 1, 0));
  const glm::dmat4 expected = glm::perspectiveLH_NO(1.0, 1.5, k_near_m, k_far_m) * view;
  expect_same_view(eye({}, view, glm::perspectiveLH_NO(1.0, 1.5, k_near_m, k_far_m)), expected);
  expect_same_view(eye({true, true, false}, view, glm::perspectiveLH_ZO(1.0, 1.5, k_near_m, k_far_m)),
                   expected);
  expect_same_view(eye({false, true, true}, view, glm::perspectiveLH_ZO(1.0, 1.5, k_far_m, k_near_m)),
                   expected);
  const glm::dmat4 parallel = glm::orthoLH_NO(-9.0, 12.0, -5.0, 6.0, k_near_m, k_far_m);
  expect_same_view(eye({}, view, parallel), parallel * view);
}

TEST(CMatrices, MayMirrorInTheViewOrTheProjection) {
  glm::dmat4 water(1.0);  // a reflection in the plane y = -1
  water[1][1] = -1.0;
  water[3][1] = -2.0;
  const glm::dmat4 mirrored = k_view * water;
  expect_same_view(eye({}, mirrored, opengl()), opengl() * mirrored);
  glm::dmat4 vulkan = glm::perspectiveRH_ZO(1.0, 1.5, k_near_m, k_far_m);
  vulkan[1][1] = -vulkan[1][1];
  expect_same_view(eye({false, true, false}, k_view, vulkan), opengl() * k_view);
}

TEST(CMatrices, MayScaleTheWorldInTheViewOrW) {
  const glm::dmat4 view = glm::scale(glm::dmat4(1.0), glm::dvec3(0.01)) * k_view;  // camera in other units
  const glm::dmat4 projection = glm::perspectiveRH_NO(1.0, 1.5, 0.01 * k_near_m, 0.01 * k_far_m);
  expect_same_view(eye({}, view, projection), opengl() * k_view);
  expect_same_view(eye({}, k_view, 3.0 * opengl()), opengl() * k_view);
}

TEST(CMatrices, AreUprightForTheCoreWhateverTheirConvention) {
  // What the core widens and predicts by; any other projection would cost margins.
  const glm::dmat4 left = glm::lookAtLH(glm::dvec3(3, 2, 5), glm::dvec3(-1, 1, -4), glm::dvec3(0, 1, 0));
  EXPECT_TRUE(is_upright_perspective(
      eye({false, true, true}, left, glm::perspectiveLH_ZO(1.0, 1.5, k_far_m, k_near_m)).clip_from_camera));
  EXPECT_TRUE(is_upright_perspective(eye({}, k_view, 3.0 * opengl()).clip_from_camera));
  EXPECT_TRUE(is_upright_perspective(
      eye({}, glm::scale(glm::dmat4(1.0), glm::dvec3(7.0)) * k_view, opengl()).clip_from_camera));
}

TEST(CMatrices, ThatHaveTheirNearPlaneBehindTheFarOneAreRefused) {
  glm::dmat4 backwards = opengl();
  backwards[3][2] = -backwards[3][2];
  EXPECT_THROW(static_cast<void>(eye({}, k_view, backwards)), Failure);
}

}  // namespace
}  // namespace sightline::c_api
