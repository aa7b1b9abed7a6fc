// The same flights under other circumstances: the audit's own image sizes, two eyes, more latency, a slower
// and a faster daemon, a control image of an eighth of the side.

#include <string>

#include "tests/quality/motions.hpp"
#include "tests/quality/quality_scenes.hpp"
#include "tests/quality/shortfalls.hpp"

namespace sightline::testing {
namespace {

const Motion k_through_the_door = with_head(walk({-1.0, 1.7, 3.0}, {0.3, 1.7, -2.0}, 1.8));
const Motion k_past_the_slit = walk({-1.5, 1.7, 6.0}, {1.5, 1.7, 6.0}, 1.2);
const Motion k_past_the_fence = walk({-2.0, 1.7, 3.0}, {2.0, 1.7, 3.0}, 2.0);
const Motion k_turning = spin({0.3, 1.7, 0.2}, 180.0);

void expect_right(const Scene& scene, const Motion& motion, double duration_s, const ServiceSetup& setup,
                  const Shortfalls& known = {}) {
  SCOPED_TRACE(std::to_string(setup.latency_s) + " s of latency");
  const FlightOutcome outcome = fly(scene, motion, duration_s, setup);
  expect_no_worse_than(known, outcome);
}

TEST(Setups, ShowTheRoomBehindADoorAtTheAuditsSizes) {
  ServiceSetup setup = default_setup(0.05);
  setup.main_size = {1024, 768};
  setup.pipeline.size = {512, 384};
  // Wrong: a slit between two boxes that no control sample meets.
  expect_right(door_scene(), k_through_the_door, 2.5, setup, {.known_wrong_frames = 3});
}

TEST(Setups, ShowWhatIsBehindAFenceAtTheAuditsSizes) {
  ServiceSetup setup = default_setup(0.1);
  setup.main_size = {1024, 768};
  setup.pipeline.size = {512, 384};
  // Wrong: right after the start, when nothing predicts yet.
  expect_right(fence_scene(), k_past_the_fence, 1.5, setup, {.known_wrong_frames = 9});
}

TEST(Setups, ShowBothEyesWhatIsTheirs) {
  for (const double latency_s : {0.05, 0.1}) {
    ServiceSetup setup = default_setup(latency_s);
    setup.eye_separation_m = 0.064;
    // Restless: what slits between boxes show at times.
    expect_right(door_scene(), k_through_the_door, 2.0, setup, {.known_restless_objects = 6});
    // Wrong: the slit closes where no control sample meets it. Drawn: few objects show, one more counts much.
    expect_right(gap_scene(0.025), k_past_the_slit, 2.0, setup,
                 {.known_wrong_frames = 21, .known_conservativity = 1.75});
  }
}

TEST(Setups, ShowEverythingWithALatencyOf200Milliseconds) {
  const ServiceSetup setup = default_setup(0.2);
  // Wrong: slits between boxes or pillars that no control sample meets.
  expect_right(door_scene(), k_through_the_door, 2.5, setup,
               {.known_wrong_frames = 3, .known_restless_objects = 9});
  expect_right(hall_scene(), k_turning, 2.5, setup, {.known_wrong_frames = 5});
  // Wrong: the start, which takes longer here, and slits between boxes.
  expect_right(cluster_scene(), orbit(9.0, 1.7, 4.0), 2.0, setup,
               {.known_wrong_frames = 54, .known_restless_objects = 13});
  expect_right(fence_scene(), k_past_the_fence, 2.0, setup, {.known_wrong_frames = 9});
}

TEST(Setups, ShowEverythingWithADaemonOfTenAnswersASecond) {
  ServiceSetup setup = default_setup(0.05);
  setup.control_rate_hz = 10.0;
  // Wrong: slits between boxes or pillars that no control sample meets.
  expect_right(door_scene(), k_through_the_door, 2.5, setup,
               {.known_wrong_frames = 4, .known_restless_objects = 8});
  expect_right(hall_scene(), k_turning, 2.5, setup, {.known_wrong_frames = 3});
}

TEST(Setups, ShowEverythingWithADaemonThatAnswersEveryFrame) {
  ServiceSetup setup = default_setup(0.05);
  setup.control_rate_hz = 60.0;
  // Wrong: slits between boxes or pillars that no control sample meets.
  expect_right(door_scene(), k_through_the_door, 2.5, setup, {.known_wrong_frames = 3});
  expect_right(hall_scene(), k_turning, 2.5, setup, {.known_wrong_frames = 4, .known_restless_objects = 6});
}

TEST(Setups, ShowEverythingThroughAControlImageOfAnEighthOfTheSide) {
  ServiceSetup setup = default_setup(0.05);
  setup.pipeline.size = {64, 48};
  // Wrong: slits that no control sample meets; a control pixel is four times as wide as elsewhere.
  expect_right(door_scene(), k_through_the_door, 2.5, setup,
               {.known_wrong_frames = 9, .known_restless_objects = 7});
  expect_right(gap_scene(0.025), k_past_the_slit, 2.0, setup, {.known_wrong_frames = 89});
}

TEST(Setups, AreRightFromTheSameRequestsTwice) {
  // The whole service is deterministic: what a flight finds can be found again.
  const auto once = fly(door_scene(), k_through_the_door, 1.0, default_setup(0.05));
  const auto twice = fly(door_scene(), k_through_the_door, 1.0, default_setup(0.05));
  EXPECT_EQ(once.summary(), twice.summary());
}

}  // namespace
}  // namespace sightline::testing
