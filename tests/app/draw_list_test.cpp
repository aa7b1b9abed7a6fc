#include "main_view/app/draw_list.hpp"

#include <limits>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

namespace sightline {
namespace {

TEST(DrawListBuilder, DrawsFarFromTheOriginWhatReachesOutOfTheTestedFieldByLessThanAFloatsStep) {
  const glm::dvec3 origin_m(1e7, 0.0, 0.0);  // floats are 1 m apart here
  const std::vector<Aabb> boxes = {{{-0.3f, -0.3f, -5.3f}, {0.3f, 0.3f, -4.7f}}};
  const ObjectHierarchy hierarchy(boxes);
  DrawListBuilder draw_list(hierarchy, origin_m);
  const Eye eye{glm::translate(glm::dmat4(1.0), -origin_m), clip_from_camera(Perspective{}, 1.0)};

  constexpr float k_infinity = std::numeric_limits<float>::infinity();
  CutOff cut{{}, {glm::vec3(-k_infinity), glm::vec3(k_infinity)}};
  cut.inner_side.planes.fill({0.0, 0.0, 0.0, 1.0});
  FrameDecision decision;
  decision.fallback = Fallback::none;
  const auto drawn_with_side_at = [&](double sign, double x_m) {
    cut.inner_side.planes[0] = {sign, 0.0, 0.0, -sign * (origin_m.x + x_m)};
    decision.fields = {{0, {cut}}};
    return draw_list.visible({&eye, 1}, decision).size();
  };
  EXPECT_EQ(drawn_with_side_at(-1.0, 0.1), 1u);
  EXPECT_EQ(drawn_with_side_at(1.0, -0.1), 1u);
  EXPECT_EQ(drawn_with_side_at(-1.0, 5.0), 0u);
  EXPECT_EQ(drawn_with_side_at(1.0, -5.0), 0u);
}

}  // namespace
}  // namespace sightline
