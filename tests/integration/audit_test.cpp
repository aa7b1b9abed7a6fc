#include <gtest/gtest.h>

#include "tests/integration/scenario.hpp"

namespace sightline {
namespace {

using namespace testing;

const std::vector<std::string> k_exact = {"--latency",      "0",       "--size",   "160x120",
                                          "--control-size", "160x120", "--filter", "1"};

std::vector<std::string> operator+(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

void expect_exact(const nlohmann::json& report, int frames) {
  ASSERT_TRUE(report.is_object());
  const auto& quality = report["quality"];
  EXPECT_EQ(quality["frames"], frames);
  EXPECT_EQ(quality["frames_with_wrong_pixels"], 0);
  EXPECT_EQ(quality["missed_objects_max"], 0);
  EXPECT_EQ(quality["conservativity_mean"], 1.0);
  EXPECT_EQ(quality["conservativity_p99"], 1.0);
  EXPECT_EQ(quality["fallback_frames"], 0);
  // The service must have had something to leave out.
  EXPECT_LT(quality["triangles_drawn"], quality["triangles_frustum"]);
}

TEST(TwoProcesses, DrawTheFullImageAtZeroLatencyAndEqualResolution) {
  expect_exact(small_city().audit(k_exact + std::vector<std::string>{"--frames", "40"}), 40);
}

TEST(TwoProcesses, AreExactForTwoEyesToo) {
  expect_exact(small_city().audit(k_exact + std::vector<std::string>{"--frames", "20", "--stereo"}), 20);
}

TEST(TwoProcesses, AreExactWithEveryCounter) {
  for (const char* counter : {"histogram", "queries", "compute"}) {
    SCOPED_TRACE(counter);
    expect_exact(
        small_city().audit(k_exact + std::vector<std::string>{"--frames", "8", "--counter", counter}), 8);
  }
}

TEST(TwoProcesses, AreExactOnTheBundledScene) {
  const auto folder = scenes_folder();
  if (!std::filesystem::exists(folder / "clinic_ground.glb"))
    GTEST_SKIP() << "scenes/clinic_ground.glb is absent";
  TemporaryFolder out;
  const Finished audit =
      run({main_view_executable(), "audit", "--spawn", "--scene", (folder / "clinic_ground.glb").string(),
           "--path", (folder / "clinic.path.csv").string(), "--latency", "0", "--size", "320x240",
           "--control-size", "320x240", "--filter", "1", "--rate", "0.2", "--json",
           (out / "report.json").string()});
  ASSERT_EQ(audit.exit_code, 0) << audit.err;
  EXPECT_NE(audit.out.find("frames_with_wrong_pixels: 0"), std::string::npos) << audit.out;
  EXPECT_NE(audit.out.find("conservativity_mean: 1.0"), std::string::npos) << audit.out;
}

TEST(TwoProcesses, ReportTheSameTwiceTimesAside) {
  const Scenario city = small_city();
  const std::vector<std::string> late = {"--latency", "50",      "--control-rate", "30",
                                         "--size",    "160x120", "--control-size", "80x60",
                                         "--frames",  "60"};
  nlohmann::json first = city.audit(late, "report.json");
  nlohmann::json second = city.audit(late, "report.json");
  ASSERT_TRUE(first.is_object() && second.is_object());
  first.erase("timing");
  second.erase("timing");
  EXPECT_EQ(first.dump(), second.dump());
}

TEST(TwoProcesses, ReportTheSameWithATruthThatIsKnown) {
  const Scenario city = small_city();
  const std::vector<std::string> late = {
      "--latency",      "200",     "--control-rate", "10",
      "--size",         "160x120", "--preset",       "avango",
      "--control-size", "80x60",   "--frames",       "160",
      "--turn",         "300",     "--truth",        city.file("views.truth")};
  nlohmann::json first = city.audit(late, "report.json");
  nlohmann::json second = city.audit(late, "report.json");
  ASSERT_TRUE(first.is_object() && second.is_object());
  EXPECT_GT(first["quality"]["frames_with_wrong_pixels"], 0);  // the images had to be drawn
  EXPECT_EQ(first["quality"].dump(), second["quality"].dump());
}

TEST(TwoProcesses, SayThePresetOfBothSides) {
  for (const char* preset : {"default", "avango"}) {
    const auto report = small_city().audit({"--size", "160x120", "--frames", "2", "--preset", preset});
    ASSERT_TRUE(report.is_object());
    EXPECT_EQ(report["settings"]["preset"], preset);
    EXPECT_EQ(report["settings"]["client_preset"], preset);
  }
}

TEST(TwoProcesses, TurnTheHeadOfACameraThatStandsStill) {
  const auto report = small_city().audit(
      {"--still", "--turn", "inf", "--size", "160x120", "--latency", "0", "--rate", "10", "--frames", "45"});
  ASSERT_TRUE(report.is_object());
  EXPECT_GT(report["quality"]["state_changes_true_mean"], 0.0);
  EXPECT_EQ(report["settings"]["turn_deg_per_s"], "inf");
}

TEST(TwoProcesses, StayNearlyRightUnderLatency) {
  const auto report = small_city().audit({"--latency", "50", "--control-rate", "30", "--size", "1024x768",
                                          "--control-size", "512x384", "--frames", "120"});
  ASSERT_TRUE(report.is_object());
  const auto& quality = report["quality"];
  EXPECT_LE(quality["wrong_pixels_mean"], 1e-4);
  EXPECT_LE(quality["conservativity_mean"], 2.0);
  EXPECT_LE(quality["fallback_last_s"], 0.5);
}

TEST(TwoProcesses, AreExactForAStillCameraOnceTheFilterHasFilled) {
  // 16 frames fill the filter of 8 at 30 answers a second. The frames after them are the ones that count:
  // with a quarter of the pixels the first are free to miss what falls between two samples.
  const Scenario city = small_city();
  const std::vector<std::string> still = {"--still", "--latency", "50",      "--control-rate",
                                          "30",      "--size",    "320x240", "--control-size",
                                          "160x120", "--start",   "7"};
  const auto filling = city.audit(still + std::vector<std::string>{"--frames", "30"});
  const auto filled = city.audit(still + std::vector<std::string>{"--frames", "60"});
  ASSERT_TRUE(filling.is_object() && filled.is_object());
  EXPECT_EQ(filled["quality"]["frames_with_wrong_pixels"], filling["quality"]["frames_with_wrong_pixels"])
      << "frames 30 to 59 have wrong pixels";
}

TEST(TwoProcesses, FallBackRatherThanBeWrongWhenTheCameraJumps) {
  // Two rooms that share no object: what is known of one says nothing about the other.
  SceneBuilder builder;
  const auto stone = builder.add_material(opaque());
  for (const double x : {0.0, 500.0}) {
    builder.add_wall({x, 0, -20}, 40, 40, stone);
    for (int i = 0; i < 30; ++i)
      builder.add_box({x - 6.0 + 0.4 * i, 0.3 * (i % 7), -12.0 - 0.2 * i}, {0.5, 2, 0.5}, stone);
  }
  std::vector<glm::dvec3> positions;
  std::vector<double> yaws;
  for (int i = 0; i < 120; ++i) {
    positions.emplace_back((i / 40) % 2 == 0 ? 0.0 : 500.0, 0.0, 0.0);
    yaws.push_back(0.002 * (i % 40));
  }
  const Scenario rooms(builder.finish(), path_through(positions, yaws));
  const auto report = rooms.audit({"--latency", "100", "--size", "160x120", "--control-size", "160x120"});
  ASSERT_TRUE(report.is_object());
  EXPECT_EQ(report["quality"]["frames_with_wrong_pixels"], 0);
  EXPECT_GT(report["quality"]["fallback_frames"], 10);  // some after each of two jumps and at the start
  EXPECT_LT(report["quality"]["fallback_frames"], 60);  // and culling comes back
}

}  // namespace
}  // namespace sightline
