#include "common/frustum.hpp"

#include <cmath>
#include <random>

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "common/bounds.hpp"
#include "common/view.hpp"

namespace sightline {
namespace {

glm::dmat4 view_from(const glm::dvec3& eye) {
  return clip_from_camera({1.0, 0.1, 100.0}, 1.3) * glm::translate(glm::dmat4(1.0), -eye);
}

TEST(Frustum, NormalsPointInwards) {
  const Frustum frustum = frustum_of(view_from({0, 0, 0}));
  for (const glm::dvec4& plane : frustum.planes) {
    EXPECT_GT(glm::dot(plane, glm::dvec4(0, 0, -5, 1)), 0.0);
    EXPECT_NEAR(glm::length(glm::dvec3(plane)), 1.0, 1e-12);
  }
  EXPECT_NEAR(frustum.planes[4].w, -0.1, 1e-9);   // near: z <= -0.1
  EXPECT_NEAR(frustum.planes[5].w, 100.0, 1e-6);  // far: z >= -100
}

TEST(Frustum, HasNoFarPlaneWhereTheProjectionHasNone) {
  const Frustum frustum = frustum_of(glm::infinitePerspectiveRH(1.0, 1.0, 0.1));
  EXPECT_EQ(frustum.planes[5], glm::dvec4(0, 0, 0, 1));
  EXPECT_TRUE(may_intersect(frustum, {{-1, -1, -1e9f}, {1, 1, -1e8f}}));
}

TEST(FrustumCulling, KeepsEveryBoxThatHoldsAPointInside) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int kept_for_nothing = 0;
  int culled = 0;
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 eye = 10.0 * glm::dvec3(unit(random), unit(random), unit(random));
    const glm::dmat4 clip = view_from(eye);
    const Frustum frustum = frustum_of(clip);
    // A corner of the box lies next to a plane, now on this side, now on that.
    const glm::dvec4 p =
        glm::inverse(clip) * glm::dvec4(1.0 + 1e-3 * unit(random), unit(random), unit(random), 1.0);
    const glm::vec3 corner(glm::dvec3(p) / p.w);
    const float size = static_cast<float>(std::exp(3.0 * unit(random)));
    const Aabb box{corner, corner + glm::vec3(size, 0.01f, 0.01f)};
    bool holds_inside_point = false;
    for (int k = 0; k <= 8; ++k) {
      const glm::dvec4 q = clip * glm::dvec4(glm::dvec3(corner) + glm::dvec3(size * k / 8.0, 0, 0), 1.0);
      holds_inside_point =
          holds_inside_point || (std::abs(q.x) <= q.w && std::abs(q.y) <= q.w && std::abs(q.z) <= q.w);
    }
    const bool kept = may_intersect(frustum, box);
    EXPECT_TRUE(kept || !holds_inside_point);
    kept_for_nothing += kept && !holds_inside_point ? 1 : 0;
    culled += kept ? 0 : 1;
  }
  EXPECT_GT(culled, 2000);
  EXPECT_LT(kept_for_nothing, 6000);
}

TEST(FrustumCulling, ContainsOnlyWhatLiesWhollyInside) {
  const Frustum frustum = frustum_of(view_from({0, 0, 0}));
  EXPECT_TRUE(definitely_contains(frustum, {{-1, -1, -10}, {1, 1, -9}}));
  EXPECT_FALSE(definitely_contains(frustum, {{-1, -1, -10}, {1, 1, -0.05f}}));
  EXPECT_FALSE(definitely_contains(frustum, {{-1, -1, -101}, {1, 1, -9}}));
  EXPECT_FALSE(definitely_contains(frustum, {{-90, -1, -10}, {1, 1, -9}}));
}

TEST(FrustumCulling, KeepsABoxAroundTheEye) {
  EXPECT_TRUE(may_intersect(frustum_of(view_from({0, 0, 0})), {{-1, -1, -1}, {1, 1, 1}}));
}

TEST(FrustumCulling, NeverKeepsAnEmptyBox) {
  const Frustum frustum = frustum_of(view_from({0, 0, 0}));
  EXPECT_FALSE(may_intersect(frustum, Aabb{}));
  EXPECT_FALSE(definitely_contains(frustum, Aabb{}));
}

TEST(FrustumCulling, KeepsABoxItCannotJudge) {
  Aabb box{{-1, -1, -10}, {1, 1, -9}};
  box.max.y = std::nanf("");
  EXPECT_TRUE(may_intersect(frustum_of(view_from({0, 0, 0})), box));
}

TEST(TransformedBox, HoldsEveryPointInSinglePrecisionToo) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 5000; ++i) {
    glm::dmat4 m(1.0);
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 3; ++row) m[column][row] = (column == 3 ? 1000.0 : 1.0) * unit(random);
    }
    const glm::vec3 low(unit(random), unit(random), unit(random));
    const Aabb box{low, low + glm::vec3(1.0f)};
    const Aabb result = transformed(box, m);
    const glm::mat4 single(m);
    for (int k = 0; k < 8; ++k) {
      const glm::vec3 corner(k & 1 ? box.max.x : box.min.x, k & 2 ? box.max.y : box.min.y,
                             k & 4 ? box.max.z : box.min.z);
      const glm::vec3 p(single * glm::vec4(corner, 1.0f));
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(p[axis], result.min[axis]);
        EXPECT_LE(p[axis], result.max[axis]);
      }
    }
    EXPECT_LT(result.extent().x, 3.1f);
  }
}

TEST(TransformedBox, StaysEmpty) {
  EXPECT_TRUE(transformed(Aabb{}, glm::dmat4(2.0)).empty());
}

}  // namespace
}  // namespace sightline
