#pragma once

#include "tests/quality/virtual_service.hpp"

namespace sightline::testing {

/// How far a flight is known to fall short of a picture without a wrong pixel. The defaults are what every
/// flight should do. Whatever a flight says instead was measured, plus a margin, with the reason beside it: a
/// known shortfall, to be lowered when the product gets better, never a goal.
struct Shortfalls {
  std::uint32_t known_wrong_frames = 0;      ///< frames that miss a visible object
  double known_conservativity = 1.5;         ///< mean of drawn / visible objects
  std::uint32_t known_fallbacks = 0;         ///< frames drawn by frustum alone, from the first answer on
  std::uint32_t known_restless_objects = 2;  ///< objects that come and go oftener than the truth
};

/// Expects no more of anything than is known.
inline void expect_no_worse_than(const Shortfalls& known, const FlightOutcome& outcome) {
  EXPECT_TRUE(has_at_most_wrong_frames(known.known_wrong_frames, outcome));
  EXPECT_TRUE(falls_back_at_most(known.known_fallbacks, outcome));
  EXPECT_TRUE(keeps_at_most(known.known_conservativity, outcome));
  EXPECT_TRUE(has_at_most_restless_objects(known.known_restless_objects, outcome));
}

}  // namespace sightline::testing
