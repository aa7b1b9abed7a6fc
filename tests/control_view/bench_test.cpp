#include "control_view/bench.hpp"

#include <fstream>
#include <numeric>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "control_view/bench_report.hpp"
#include "control_view/bench_views.hpp"
#include "control_view/command_line.hpp"
#include "control_view/instruction_counter.hpp"
#include "tests/control_view/fake_engine.hpp"

namespace sightline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

CameraPath path_of(double duration_s) {
  CameraPath path;
  path.samples.push_back({0.0, {}});
  path.samples.push_back({duration_s, {}});
  return path;
}

PixelCounts counts_of(std::vector<std::uint32_t> ids, std::vector<std::uint32_t> pixels) {
  PixelCounts counts;
  for (const std::uint32_t id : ids) counts.ids.push_back(ObjectId{id});
  counts.pixels = std::move(pixels);
  return counts;
}

std::string refusal_of(const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"bench", "--scene", "s", "--path", "p", "--json", "j"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  try {
    (void)parse_command_line(arguments);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no InputError";
}

/// Where an eye stands and where it looks.
glm::dvec3 place_of(const Eye& eye) {
  return glm::dvec3(glm::inverse(eye.camera_from_world)[3]);
}
glm::dvec3 gaze_of(const Eye& eye) {
  return -glm::dvec3(glm::inverse(eye.camera_from_world)[2]);
}

TEST(BenchOptions, ReadsEveryArgument) {
  const auto options = std::get<BenchOptions>(parse_command_line(
      {"bench",  "--scene", "s",   "--path",      "p",        "--json",   "j",         "--views",
       "around", "--start", "2.5", "--step",      "30",       "--frames", "7",         "--threads",
       "3",      "--rate",  "10",  "--no-oracle", "--engine", "raycast",  "--lead-in", "0.05"}));
  EXPECT_EQ(options.lead_in_s, 0.05);
  EXPECT_EQ(options.views, BenchViews::around);
  EXPECT_EQ(options.start_s, 2.5);
  EXPECT_EQ(options.step, 30u);
  EXPECT_EQ(options.frames, 7u);
  EXPECT_EQ(options.threads, 3u);
  EXPECT_FALSE(options.oracle);
  EXPECT_TRUE(
      std::get<BenchOptions>(parse_command_line({"bench", "--scene", "s", "--path", "p", "--json", "j"}))
          .oracle);
}

TEST(BenchOptions, NamesTheArgumentItRefuses) {
  EXPECT_THAT(refusal_of({"--views", "sideways"}), HasSubstr("--views"));
  EXPECT_THAT(refusal_of({"--step", "0"}), HasSubstr("--step"));
  EXPECT_THAT(refusal_of({"--start", "-1"}), HasSubstr("--start"));
  EXPECT_THAT(refusal_of({"--lead-in", "-1"}), HasSubstr("--lead-in"));
  EXPECT_THAT(refusal_of({"--threads", "100000"}), HasSubstr("--threads"));
}

TEST(BenchTimes, TakesEveryStepthFrameFromTheStartOn) {
  BenchOptions options;
  options.rate_hz = 10.0;
  EXPECT_EQ(bench_times(path_of(2.0), options).size(), 21u);
  options.start_s = 1.0;
  options.step = 4;
  EXPECT_THAT(bench_times(path_of(2.0), options), ElementsAre(1.0, 1.4, 1.8));
  options.frames = 2;
  EXPECT_THAT(bench_times(path_of(2.0), options), ElementsAre(1.0, 1.4));
}

TEST(BenchTimes, RefusesAStartBeyondThePathAndAPathWithoutEnd) {
  BenchOptions options;
  options.start_s = 3.0;
  EXPECT_THROW((void)bench_times(path_of(2.0), options), InputError);
  options.start_s = 0.0;
  EXPECT_THROW((void)bench_times(path_of(1e12), options), InputError);
}

TEST(BenchViews, KnowsItsOwnNames) {
  for (const char* name : {"single", "stereo", "around", "region"}) {
    EXPECT_EQ(name_of(parse_bench_views(name)), name);
  }
  EXPECT_THROW((void)parse_bench_views("Single"), InputError);
}

TEST(BenchViews, LooksAllAroundWithSixSquareFaces) {
  const Pose pose{{1, 2, 3}, glm::angleAxis(0.7, glm::normalize(glm::dvec3(1, 2, -1)))};
  const BenchQuery query = bench_query(BenchViews::around, pose, {512, 384});
  EXPECT_EQ(query.size, (ImageSize{384, 384}));
  ASSERT_EQ(query.eyes.size(), 6u);
  glm::dvec3 sum(0.0);
  for (const Eye& eye : query.eyes) {
    EXPECT_LT(glm::length(place_of(eye) - pose.position_m), 1e-9);
    sum += gaze_of(eye);
    // 90 degrees: an edge of the image is as far from its middle as it is away.
    EXPECT_NEAR(eye.clip_from_camera[0][0], 1.0, 1e-12);
    EXPECT_NEAR(eye.clip_from_camera[1][1], 1.0, 1e-12);
    for (const Eye& other : query.eyes) {
      const double cosine = glm::dot(gaze_of(eye), gaze_of(other));
      EXPECT_TRUE(&eye == &other || cosine < 1e-9) << "two faces look the same way";
    }
  }
  EXPECT_LT(glm::length(sum), 1e-9);
}

TEST(BenchViews, StandsAsFarApartAsItSays) {
  const Pose pose{{1, 2, 3}, glm::angleAxis(0.7, glm::normalize(glm::dvec3(1, 2, -1)))};
  const BenchQuery stereo = bench_query(BenchViews::stereo, pose, {512, 384});
  ASSERT_EQ(stereo.eyes.size(), 2u);
  EXPECT_NEAR(glm::length(place_of(stereo.eyes[0]) - place_of(stereo.eyes[1])), 0.064, 1e-9);
  const BenchQuery region = bench_query(BenchViews::region, pose, {512, 384});
  ASSERT_EQ(region.eyes.size(), 5u);
  for (const Eye& eye : region.eyes) EXPECT_LE(glm::length(place_of(eye) - pose.position_m), 0.1 + 1e-9);
  EXPECT_EQ(bench_query(BenchViews::single, pose, {512, 384}).eyes.size(), 1u);
}

TEST(BenchReport, CountsAPixelThatChangedItsOwnerOnce) {
  const PixelCounts exact = counts_of({1, 5, 9}, {10, 20, 30});
  EXPECT_EQ(differing_pixels_of(exact, exact), 0.0);
  EXPECT_EQ(differing_pixels_of(counts_of({1, 5, 9}, {13, 17, 30}), exact), 3.0);
  EXPECT_EQ(differing_pixels_of(counts_of({2, 5, 9}, {10, 20, 30}), exact), 10.0);
  EXPECT_EQ(differing_pixels_of(counts_of({1, 5}, {10, 20}), exact), 15.0) << "to background: half";
  EXPECT_EQ(differing_pixels_of(counts_of({}, {}), exact), 30.0);
  EXPECT_EQ(differing_pixels_of(exact, counts_of({}, {})), 30.0);
}

TEST(BenchReport, TellsMissedFromKept) {
  EngineTally tally;
  tally.add({{}, 0.002, 1000}, counts_of({1, 3}, {5, 5}), counts_of({1, 2, 4}, {5, 3, 2}), 100.0);
  tally.add({{}, 0.004, 3000}, counts_of({1}, {5}), counts_of({1}, {5}), 100.0);
  const nlohmann::json json = to_json(tally);
  EXPECT_EQ(json["missed"], 1.0);
  EXPECT_EQ(json["kept"], 0.5);
  EXPECT_EQ(json["reported"], 1.5);
  EXPECT_EQ(json["differing_pixels_share"], 5.0 / 200.0);
  EXPECT_EQ(json["instructions"], 2000.0);
  EXPECT_EQ(json["frame_ms"]["mean"], 3.0);
}

TEST(BenchReport, SaysNothingOfInstructionsThatWereNotAllCounted) {
  EngineTally tally;
  tally.add({{}, 0.002, 1000}, {}, {}, 100.0);
  tally.add({{}, 0.002, {}}, {}, {}, 100.0);
  EXPECT_TRUE(to_json(tally)["instructions"].is_null());
}

TEST(InstructionCounter, CountsWhatTheThreadDoesOrNothing) {
  const InstructionCounter counter;
  const auto before = counter.read();
  if (!before) GTEST_SKIP() << "this machine does not let instructions be counted";
  volatile int sum = 0;
  for (int i = 0; i < 100'000; ++i) sum = sum + i;
  EXPECT_GT(*counter.read(), *before + 100'000);
}

TEST(EngineThread, PassesOnWhatItsEngineThrows) {
  EXPECT_THROW(EngineThread([]() -> std::unique_ptr<VisibilityEngine> { throw MachineError("no context"); }),
               MachineError);
  EngineThread thread([] {
    auto engine = std::make_unique<test::FakeEngine>();
    engine->lose_context = true;
    return engine;
  });
  PixelCounts counts;
  EXPECT_THROW((void)thread.count({}, counts), MachineError);
  EXPECT_GE(thread.build_time_s(), 0.0);
}

}  // namespace
}  // namespace sightline
