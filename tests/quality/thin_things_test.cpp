// What a control pixel hardly holds: far poles, slabs seen edge-on, and what the near plane cuts.

#include "tests/quality/quality_fixture.hpp"

namespace sightline::testing {
namespace {

class ThinThings : public Flight {};
SIGHTLINE_FLIGHTS(ThinThings);

TEST_P(ThinThings, AreDrawnWhereFarPolesAreThinnerThanAPixel) {
  // Drawn: few poles show, one more counts much.
  expect_right(needle_scene(), walk({-1.0, 1.7, 4.0}, {1.0, 1.7, 0.0}, 2.0), 2.0,
               {.known_conservativity = 2.05});
}

TEST_P(ThinThings, AreDrawnWhereFarPolesPassAHeadThatBobs) {
  // Drawn: few poles show, one more counts much.
  expect_right(needle_scene(), with_head(walk({-6.0, 1.7, 0.0}, {6.0, 1.7, 0.0}, 6.0)), 2.0,
               {.known_conservativity = 1.85});
}

TEST_P(ThinThings, AreDrawnWhereOneWalksLevelWithASlab) {
  // The eye goes through the planes of the slab at 1.7 m and of what lies on it.
  // Wrong: at the start, and single pixels of slits no control sample meets. Restless: the same slits.
  expect_right(slab_scene(), with_head(walk({0.0, 1.7, 2.0}, {0.0, 1.7, -4.0}, 2.0)), 3.0,
               {.known_wrong_frames = 18, .known_restless_objects = 17});
}

TEST_P(ThinThings, AreDrawnWhereOneRisesThroughTheLevelsOfSlabs) {
  // Wrong: at the start, and single pixels of slits no control sample meets.
  expect_right(slab_scene(), walk({0.2, 0.9, 1.0}, {0.0, 2.6, 0.0}, 0.8), 2.4, {.known_wrong_frames = 20});
}

class CloseWalls : public Flight {};
SIGHTLINE_FLIGHTS(CloseWalls);

TEST_P(CloseWalls, ShowWhatTheNearPlaneCutsOpen) {
  // The camera slides along a wall at 8 cm, nearer than its near plane reaches at the image's edge.
  // Wrong: right after the start, when nothing predicts yet. Drawn: few objects show, one more counts much.
  expect_right(wall_scene(), walk({0.13, 1.7, 5.0}, {0.13, 1.7, -2.0}, 2.0, 20.0), 2.5,
               {.known_wrong_frames = 6, .known_conservativity = 2.6, .known_restless_objects = 12});
}

TEST_P(CloseWalls, ShowWhatIsBehindThemToACameraThatWalksThrough) {
  // Drawn: before the wall few objects show, one more counts much.
  expect_right(wall_scene(), walk({2.0, 1.7, 0.0}, {-2.0, 1.7, -1.0}, 1.6, 70.0), 2.5,
               {.known_conservativity = 2.9});
}

TEST_P(CloseWalls, HideWhatIsBehindThemFromACameraThatBrushesThem) {
  // Restless: what the edge of the wall uncovers.
  expect_right(wall_scene(), with_head(walk({0.3, 1.7, 5.0}, {0.2, 1.7, -2.0}, 2.0, 10.0)), 2.5,
               {.known_restless_objects = 5});
}

}  // namespace
}  // namespace sightline::testing
