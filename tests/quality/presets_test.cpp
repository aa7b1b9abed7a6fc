// That these flights bite: the settings of the paper lose something in every one of them, the default loses
// little of that, and without the mechanisms that the default has beyond the paper it loses more again.

#include <cstdint>
#include <map>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "tests/quality/motions.hpp"
#include "tests/quality/quality_scenes.hpp"

namespace sightline::testing {
namespace {

constexpr double k_latency_s = 0.1;
constexpr std::uint32_t k_least_lost_by_avango = 4;  // wrong frames; a flight with fewer compares nothing

struct ComparedFlight {
  std::string name;
  Scene (*scene)();
  Motion motion;
  double duration_s;
  /// Wrong frames of the default / of avango's: measured and a margin where it is more than a third.
  double known_share = 1.0 / 3.0;
};

/// For GoogleTest, which would print the bytes.
void PrintTo(const ComparedFlight& flight, std::ostream* out) {  // NOLINT(readability-identifier-naming)
  *out << flight.name;
}

/// One for each way in which something is lost. Of the wall everything and of the
/// cluster nearly every pixel is lost at the start, before anything predicts.
std::vector<ComparedFlight> compared_flights() {
  const auto door = [] { return door_scene(); };
  const auto slit = [] { return gap_scene(0.025); };
  return {
      {"ATurningHead", hall_scene, spin({0.3, 1.7, 0.2}, 180.0), 2.0},
      {"ADoorOneWalksThrough", door, with_head(walk({-1.0, 1.7, 3.0}, {0.3, 1.7, -2.0}, 1.8)), 2.0},
      {"ADoorOneRunsThrough", door, with_head(walk({-1.0, 1.7, 3.0}, {0.3, 1.7, -2.0}, 4.0)), 2.0},
      {"ADoorOneWalksPast", door, walk({-3.0, 1.7, 1.2}, {3.0, 1.7, 1.2}, 2.0), 2.0},
      {"ASlit", slit, walk({-1.5, 1.7, 6.0}, {1.5, 1.7, 6.0}, 1.2), 2.5, 0.85},  // no control sample meets it
      {"AFence", fence_scene, with_head(walk({-6.0, 1.7, 4.0}, {6.0, 1.7, 4.0}, 6.0, -20.0)), 1.5},
      {"FarPoles", needle_scene, walk({-1.0, 1.7, 4.0}, {1.0, 1.7, 0.0}, 2.0), 2.0},
      {"ASlabSeenEdgeOn", slab_scene, with_head(walk({0.0, 1.7, 2.0}, {0.0, 1.7, -4.0}, 2.0)), 2.0},
      {"AWallOneBrushes", wall_scene, walk({0.13, 1.7, 5.0}, {0.13, 1.7, -2.0}, 2.0, 20.0), 2.0, 0.6},
      {"AClusterOneCircles", cluster_scene, orbit(9.0, 1.7, 4.0), 2.0, 0.5},
      {"AClusterOneRacesAround", cluster_scene, orbit(9.0, 2.5, 12.0), 2.0},
      {"ACorridorOneRacesAlong", corridor_scene, with_head(walk({0, 1.7, -1.0}, {0, 1.7, -30.0}, 12.0)), 2.0},
  };
}

ServiceSetup default_without_extents(double latency_s) {
  ServiceSetup setup = default_setup(latency_s);
  setup.pipeline.extents = false;
  return setup;
}

ServiceSetup default_without_open_objects(double latency_s) {
  ServiceSetup setup = default_setup(latency_s);
  setup.pipeline.sample_px.reset();
  return setup;
}

/// Which service it is.
using SetupMaker = ServiceSetup (*)(double latency_s);

struct Loss {
  std::uint32_t wrong_frames = 0;
  std::uint64_t wrong_pixels = 0;
};

std::ostream& operator<<(std::ostream& out, const Loss& loss) {
  return out << loss.wrong_frames << " frames, " << loss.wrong_pixels << " pixels";
}

/// Each is flown once in a process, though the tests look at it more often.
Loss loss_of(const ComparedFlight& flight, SetupMaker setup) {
  static std::map<std::pair<std::string, SetupMaker>, Loss> flown;
  const auto [entry, is_new] = flown.try_emplace({flight.name, setup});
  if (is_new) {
    const FlightOutcome outcome = fly(flight.scene(), flight.motion, flight.duration_s, setup(k_latency_s));
    entry->second = {outcome.wrong_frames(), outcome.wrong_pixels()};
  }
  return entry->second;
}

Loss sum_of_losses(SetupMaker setup) {
  Loss sum;
  for (const ComparedFlight& flight : compared_flights()) {
    const Loss loss = loss_of(flight, setup);
    sum.wrong_frames += loss.wrong_frames;
    sum.wrong_pixels += loss.wrong_pixels;
  }
  return sum;
}

class Presets : public ::testing::TestWithParam<ComparedFlight> {};
INSTANTIATE_TEST_SUITE_P(At, Presets, ::testing::ValuesIn(compared_flights()),
                         [](const auto& flight) { return flight.param.name; });

TEST_P(Presets, TheDefaultLosesLittleOfWhatThePaperLoses) {
  const Loss lost = loss_of(GetParam(), default_setup), by_avango = loss_of(GetParam(), avango_setup);
  EXPECT_GE(by_avango.wrong_frames, k_least_lost_by_avango);
  EXPECT_LE(lost.wrong_frames, GetParam().known_share * by_avango.wrong_frames)
      << lost << "; avango: " << by_avango;
  EXPECT_LT(lost.wrong_pixels, by_avango.wrong_pixels);
}

TEST(PresetSums, AreMuchSmallerWithTheDefaultThanWithThePapersSettings) {
  const Loss lost = sum_of_losses(default_setup), by_avango = sum_of_losses(avango_setup);
  EXPECT_LE(6 * lost.wrong_frames, by_avango.wrong_frames) << lost << "; avango: " << by_avango;
  // Five sixths of avango's pixels are the turning head's.
  EXPECT_LE(15 * lost.wrong_pixels, by_avango.wrong_pixels) << lost << "; avango: " << by_avango;
}

TEST(PresetSums, AreLargerWithoutTheDirectionsInWhichObjectsWereSeen) {
  // More frames; of pixels hardly more, as those are the start's.
  const Loss lost = sum_of_losses(default_setup), without = sum_of_losses(default_without_extents);
  EXPECT_GE(3 * without.wrong_frames, 4 * lost.wrong_frames) << lost << "; without: " << without;
  EXPECT_GT(without.wrong_pixels, lost.wrong_pixels);
}

TEST(PresetSums, AreMuchLargerWithoutTheObjectsThatMayShowBetweenSamples) {
  const Loss lost = sum_of_losses(default_setup), without = sum_of_losses(default_without_open_objects);
  EXPECT_GE(without.wrong_frames, 4 * lost.wrong_frames) << lost << "; without: " << without;
  EXPECT_GE(without.wrong_pixels, 8 * lost.wrong_pixels) << lost << "; without: " << without;
}

}  // namespace
}  // namespace sightline::testing
