// Visibility from a point does not depend on where the eye looks: turning must show nothing late, and must
// not make the service draw everything either.

#include "tests/quality/quality_fixture.hpp"

namespace sightline::testing {
namespace {

constexpr glm::dvec3 k_middle(0.3, 1.7, 0.2);

class Turning : public Flight {};
SIGHTLINE_FLIGHTS(Turning);

TEST_P(Turning, ShowsWhatWasBehindTheCameraAt90DegreesASecond) {
  expect_right(hall_scene(), spin(k_middle, 90.0), 2.5);
}

TEST_P(Turning, ShowsWhatWasBehindTheCameraAt180DegreesASecond) {
  // Wrong: a gap between two pillars that no control sample meets.
  expect_right(hall_scene(), spin(k_middle, 180.0), 2.5, {.known_wrong_frames = 5});
}

TEST_P(Turning, ShowsWhatWasBehindTheCameraAt300DegreesASecond) {
  // Wrong: a gap between two pillars that no control sample meets.
  expect_right(hall_scene(), spin(k_middle, 300.0), 2.5, {.known_wrong_frames = 3});
}

TEST_P(Turning, ShowsWhatWasBehindTheCameraToAnInstantGlance) {
  // Drawn: a jump, and until an answer knows of it the frustum is drawn.
  expect_right(hall_scene(), glances(k_middle, 150.0), 2.5,
               {.known_conservativity = 1.75, .known_fallbacks = 14});
}

TEST_P(Turning, ShowsWhatIsBesideTheImageToASmallGlance) {
  // Too small to be taken for a jump.
  // Restless: what the glance, not foreseen, uncovers.
  expect_right(hall_scene(), glances(k_middle, 18.0), 2.5, {.known_restless_objects = 5});
}

TEST_P(Turning, ShowsItWhileTheHeadNods) {
  const Motion motion = [](double t) {
    return looking(k_middle, 40.0 * std::sin(2.0 * t), 35.0 * std::sin(5.0 * t));
  };
  // Restless: what gaps between pillars show at times.
  expect_right(hall_scene(), motion, 2.5, {.known_restless_objects = 5});
}

TEST_P(Turning, ShowsItWhileWalking) {
  const Motion motion = [](double t) {
    return looking({-2.0 + 1.4 * t, 1.7, 1.0}, 200.0 * std::max(t - 1.0, 0.0));
  };
  // Wrong: right after the start, when nothing predicts yet.
  expect_right(hall_scene(), motion, 2.5, {.known_wrong_frames = 6});
}

}  // namespace
}  // namespace sightline::testing
