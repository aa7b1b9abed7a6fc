// Going fast: around a cluster of objects, and along a corridor and around its corner.

#include <algorithm>
#include <cmath>

#include "tests/quality/quality_fixture.hpp"

namespace sightline::testing {
namespace {

/// Along the corridor of corridor_scene() at a constant speed: straight, a quarter circle of 2 m, straight.
Motion through_the_corridor(double speed_m_per_s, double start_m) {
  return [=](double t) {
    constexpr double k_straight_m = 36.0, k_radius_m = 2.0;
    const double quarter_m = std::acos(0.0) * k_radius_m;
    const double gone_m = start_m + speed_m_per_s * t;
    const double in_turn = std::clamp((gone_m - k_straight_m) / quarter_m, 0.0, 1.0) * std::acos(0.0);
    const double beyond_m = std::max(gone_m - k_straight_m - quarter_m, 0.0);
    const glm::dvec3 at(k_radius_m * (1.0 - std::cos(in_turn)) + beyond_m, 1.7,
                        -std::min(gone_m, k_straight_m) - k_radius_m * std::sin(in_turn));
    return looking(at, -in_turn * 90.0 / std::acos(0.0));
  };
}

class Travelling : public Flight {};
SIGHTLINE_FLIGHTS(Travelling);

TEST_P(Travelling, ShowsEverySideOfAClusterOneCircles) {
  // Wrong: at the start, and slits between boxes that no control sample meets.
  expect_right(cluster_scene(), orbit(9.0, 1.7, 4.0), 2.5,
               {.known_wrong_frames = 45, .known_restless_objects = 12});
}

TEST_P(Travelling, ShowsEverySideOfAClusterOneRacesAround) {
  // Wrong: at the start, and slits between boxes that no control sample meets. Drawn and restless: what may
  // show from anywhere the camera may be, which is a long way at 12 m/s.
  expect_right(cluster_scene(), orbit(9.0, 2.5, 12.0), 2.5,
               {.known_wrong_frames = 26, .known_conservativity = 1.8, .known_restless_objects = 43});
}

TEST_P(Travelling, ShowsWhatIsRoundTheCornerAtAWalk) {
  expect_right(corridor_scene(), with_head(through_the_corridor(1.6, 33.5)), 3.0);
}

TEST_P(Travelling, ShowsWhatIsRoundTheCornerAtTwelveMetresASecond) {
  // Drawn: the corner comes like a jump, and until an answer knows of it the frustum is drawn.
  expect_right(corridor_scene(), through_the_corridor(12.0, 18.0), 2.5,
               {.known_conservativity = 5.2, .known_fallbacks = 16, .known_restless_objects = 195});
}

TEST_P(Travelling, ShowsWhatIsInTheRoomsBesideACorridorAtTwelveMetresASecond) {
  expect_right(corridor_scene(), with_noise(with_head(through_the_corridor(12.0, 1.0))), 2.5);
}

TEST_P(Travelling, ShowsTheSameStoppingAndStarting) {
  // Half a second at 3 m/s, half a second still: no prediction sees either coming.
  const Motion motion = [](double t) {
    const double gone_m = 3.0 * (0.5 * std::floor(t) + std::min(t - std::floor(t), 0.5));
    return looking({-3.0 + gone_m, 1.7, 1.2}, 0.0);
  };
  // Wrong: right after each start. Drawn: hardly anything shows at first, one object more counts much.
  expect_right(door_scene(), motion, 3.0,
               {.known_wrong_frames = 17, .known_conservativity = 6.25, .known_restless_objects = 22});
}

}  // namespace
}  // namespace sightline::testing
