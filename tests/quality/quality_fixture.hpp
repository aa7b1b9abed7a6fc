#pragma once

#include <gtest/gtest.h>

#include "tests/quality/motions.hpp"
#include "tests/quality/quality_scenes.hpp"
#include "tests/quality/shortfalls.hpp"
#include "tests/quality/virtual_service.hpp"

namespace sightline::testing {

/// Flights with the default settings; the parameter is the latency, milliseconds.
class Flight : public ::testing::TestWithParam<int> {
 protected:
  [[nodiscard]] static ServiceSetup setup() { return default_setup(GetParam() / 1000.0); }

  /// `known` holds for every latency: it is what the worst of them does.
  static FlightOutcome expect_right(const Scene& scene, const Motion& motion, double duration_s,
                                    const Shortfalls& known = {}) {
    FlightOutcome outcome = fly(scene, motion, duration_s, setup());
    RecordProperty("outcome", outcome.summary());
    expect_no_worse_than(known, outcome);
    return outcome;
  }
};

/// `Openings` becomes `Openings.ShowsWhatIsBehindADoor/50ms` and `/100ms`.
#define SIGHTLINE_FLIGHTS(suite)                  \
  INSTANTIATE_TEST_SUITE_P(                       \
      Latency, suite, ::testing::Values(50, 100), \
      [](const ::testing::TestParamInfo<int>& latency) { return std::to_string(latency.param) + "ms"; })

}  // namespace sightline::testing
