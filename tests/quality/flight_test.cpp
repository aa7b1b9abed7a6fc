// What the flights themselves report, against a service that cannot be wrong and one that is always wrong.

#include "tests/quality/motions.hpp"
#include "tests/quality/quality_scenes.hpp"
#include "tests/quality/shortfalls.hpp"

namespace sightline::testing {
namespace {

TEST(Flights, FindNothingWrongWithNoLatencyAndTheFullSize) {
  ServiceSetup setup = avango_setup(0.0);
  setup.control_rate_hz = setup.frame_rate_hz;
  setup.pipeline.size = setup.main_size;
  setup.pipeline.filter_length = 1;
  setup.culling.max_horizon_s = 0.0;  // asks for the view at hand
  const FlightOutcome outcome = fly(fence_scene(), walk({-2.0, 1.7, 3.0}, {2.0, 1.7, 3.0}, 2.0), 1.0, setup);
  expect_no_worse_than({.known_conservativity = 1.0 + 1e-9, .known_restless_objects = 0}, outcome);
}

TEST(Flights, SayWhatIsWrong) {
  // One answer and no other: what comes into view later is lost, and after a while everything is drawn.
  ServiceSetup setup = avango_setup(0.0);
  setup.control_rate_hz = 0.1;
  setup.culling.max_staleness_s = 0.3;
  const FlightOutcome outcome = fly(hall_scene(), spin({0.3, 1.7, 0.2}, 180.0), 1.3, setup);
  EXPECT_GT(outcome.fallbacks_after_first_answer(), 10u);
  EXPECT_FALSE(falls_back_at_most(10, outcome));
  EXPECT_GT(outcome.conservativity_of_the_frustum(), 2.0);
  EXPECT_FALSE(keeps_at_most(1.5, outcome));
}

}  // namespace
}  // namespace sightline::testing
