#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "main_view/client/culling_core.hpp"
#include "main_view/client/field_coverage.hpp"

namespace sightline {
namespace {

constexpr double k_degree = 3.141592653589793 / 180.0;

class Cases {
 public:
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  glm::dvec3 direction() {
    std::normal_distribution<double> normal;
    return glm::normalize(glm::dvec3(normal(random_), normal(random_), normal(random_)));
  }
  Pose pose() {
    return {glm::dvec3(uniform(-100, 100), uniform(0, 20), uniform(-100, 100)),
            glm::angleAxis(uniform(0, 6.28), direction())};
  }
  Pose near(const Pose& pose, double distance_m, double angle_rad) {
    return {pose.position_m + uniform(0, distance_m) * direction(),
            glm::normalize(glm::angleAxis(uniform(0, angle_rad), direction()) * pose.world_from_camera)};
  }
  /// A point that the eye sees, at 0.2 to 50 m.
  glm::dvec3 seen_point(const Pose& pose, double tangent_x, double tangent_y) {
    const double depth = std::exp(uniform(std::log(0.2), std::log(50.0)));
    return pose.position_m +
           pose.world_from_camera *
               (depth * glm::dvec3(uniform(-tangent_x, tangent_x), uniform(-tangent_y, tangent_y), -1.0));
  }

 private:
  std::mt19937 random_{11};
};

const RigEye k_eye{glm::dmat4(1.0), clip_from_camera(Perspective{}, 4.0 / 3.0)};
const double k_tangent_y = std::tan(30.0 * k_degree);
const double k_tangent_x = k_tangent_y * 4.0 / 3.0;

bool is_covered(const std::vector<CutOff>& cuts) {
  return cuts.empty();
}

bool inside(const Frustum& frustum, const glm::dvec3& point) {
  for (const glm::dvec4& plane : frustum.planes) {
    if (glm::dot(plane, glm::dvec4(point, 1.0)) < 0.0) return false;
  }
  return true;
}

Aabb box_around(const glm::dvec3& point, double half_m) {
  Aabb box;
  box.add(glm::vec3(point - half_m));
  box.add(glm::vec3(point + half_m));
  return box;
}

struct Scenario {
  Pose now;
  FrameDecision decision;
};

/// Sets before and after now, seen from nearby poses with a guard of 0 to 10 degrees.
Scenario scenario(Cases& cases, double distance_m, double angle_rad) {
  CullingCore core({}, {k_eye});
  Scenario result{cases.pose(), {}};
  core.add_pose({1.0, result.now});
  for (const double time_s : {0.99, 1.01}) {
    ViewRequest request;
    request.request_seq = time_s < 1.0 ? 1 : 2;
    request.for_time_s = time_s;
    request.eyes = eyes_of(cases.near(result.now, distance_m, angle_rad), core.rig());
    request.rotation_error_rad = cases.uniform(0.0, 10.0 * k_degree);
    core.accept(request, 0.9, VisibleSet(), 1.0);
  }
  result.decision = core.decide(1.0, eyes_of(result.now, core.rig()));
  return result;
}

// The plain version: a point in view that lies in none of the tested fields has not been tested.
TEST(FieldCoverage, KeepsWhateverReachesIntoViewWhereNobodyLooked) {
  Cases cases;
  int untested_points = 0;
  int covered_frames = 0;
  for (int round = 0; round < 2000; ++round) {
    const auto [now, decision] = scenario(cases, 0.2, 14.0 * k_degree);
    ASSERT_EQ(decision.fallback, Fallback::none);
    covered_frames += decision.field_covered;
    for (int i = 0; i < 50; ++i) {
      // Half of them at the view's edges, where the truth is decided.
      glm::dvec3 point = cases.seen_point(now, k_tangent_x, k_tangent_y);
      if (i % 2 == 0) {
        const double sign = cases.uniform(-1, 1) < 0 ? -0.999 : 0.999;
        const double depth = cases.uniform(0.2, 30.0);
        point = now.position_m +
                now.world_from_camera *
                    (depth * glm::dvec3(sign * k_tangent_x, cases.uniform(-1, 1) * k_tangent_y, -1.0));
      }
      const bool tested = inside(decision.tested[0], point) || inside(decision.tested[1], point);
      if (tested) continue;
      ++untested_points;
      EXPECT_TRUE(decision.may_be_visible(ObjectId{1}, box_around(point, cases.uniform(0.0, 2.0))));
    }
  }
  EXPECT_GT(untested_points, 1000);
  EXPECT_GT(covered_frames, 20);
}

TEST(FieldCoverage, CullsMostSmallObjectsThatWereTested) {
  Cases cases;
  int tested = 0;
  int kept = 0;
  for (int round = 0; round < 500; ++round) {
    const auto [now, decision] = scenario(cases, 0.2, 14.0 * k_degree);
    for (int i = 0; i < 50; ++i) {
      const glm::dvec3 point = cases.seen_point(now, k_tangent_x, k_tangent_y);
      if (!inside(decision.tested[0], point) && !inside(decision.tested[1], point)) continue;
      ++tested;
      kept += decision.may_be_visible(ObjectId{1}, box_around(point, 0.01));
    }
  }
  EXPECT_LT(kept, tested / 20) << tested;
}

TEST(FieldCoverage, CoversAViewTurnedByLessThanTheGuard) {
  Cases cases;
  for (int round = 0; round < 2000; ++round) {
    const Pose asked = cases.pose();
    const double guard = cases.uniform(1.0, 25.0) * k_degree;
    const Pose now = cases.near(asked, 0.0, guard);
    EXPECT_TRUE(is_covered(cut_offs(eyes_of(asked, {&k_eye, 1})[0], guard, eyes_of(now, {&k_eye, 1})[0])));
  }
}

TEST(FieldCoverage, DoesNotCoverAViewTurnedByMore) {
  Cases cases;
  for (int round = 0; round < 500; ++round) {
    const Pose asked = cases.pose();
    const glm::dquat turn = glm::angleAxis(20.0 * k_degree, glm::dvec3(0.0, 1.0, 0.0));
    const Pose now{asked.position_m, asked.world_from_camera * turn};
    const Eye eye = eyes_of(now, {&k_eye, 1})[0];
    EXPECT_FALSE(is_covered(cut_offs(eyes_of(asked, {&k_eye, 1})[0], 10.0 * k_degree, eye)));
  }
}

TEST(FieldCoverage, CoversItselfForAnyProjection) {
  Cases cases;
  const glm::dmat4 ortho(0.1, 0, 0, 0, 0, 0.1, 0, 0, 0, 0, -0.01, 0, 0, 0, -1, 1);
  const glm::dmat4 infinite(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, -1, 0, 0, -0.2, 0);
  for (const glm::dmat4& projection : {k_eye.clip_from_camera, ortho, infinite}) {
    const Eye eye{camera_from_world(cases.pose()), projection};
    EXPECT_TRUE(is_covered(cut_offs(eye, 0.0, eye)));
    Eye other = eye;
    other.camera_from_world = camera_from_world(cases.pose());
    EXPECT_FALSE(is_covered(cut_offs(eye, 0.1, other)));
  }
  // An infinite projection widens and covers like a finite one.
  const Eye asked{camera_from_world({}), infinite};
  const Eye turned{camera_from_world({{}, glm::angleAxis(0.05, glm::dvec3(0, 1, 0))}), infinite};
  EXPECT_TRUE(is_covered(cut_offs(asked, 0.06, turned)));
  EXPECT_FALSE(is_covered(cut_offs(asked, 0.04, turned)));
}

}  // namespace
}  // namespace sightline
