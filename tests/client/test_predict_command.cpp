#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/camera_path.hpp"
#include "common/error.hpp"
#include "main_view/app/predict_command.hpp"

namespace sightline {
namespace {

class PredictCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ =
        std::filesystem::path(::testing::TempDir()) / (std::string("sightline_predict_") + info->name());
    std::filesystem::create_directories(folder_);
    options_.json = folder_ / "predict.json";
    options_.traces = {folder_ / "walk.csv"};
    CameraPath path;
    for (int i = 0; i < 200; ++i) {
      const double time_s = i / 60.0 + (i < 100 ? 0.0 : 5.0);  // a pause in the middle
      path.samples.push_back({time_s, {{1.5 * time_s, 1.7, 0.0}, {1.0, 0.0, 0.0, 0.0}}});
    }
    write_camera_path(options_.traces[0], path);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string error() {
    try {
      run_predict(options_);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }

  std::filesystem::path folder_;
  PredictOptions options_;
};

TEST_F(PredictCommand, WritesARowForEachTraceHorizonAndPredictor) {
  options_.horizons = {1, 5};
  ASSERT_EQ(run_predict(options_), 0);
  const auto report = nlohmann::json::parse(std::ifstream(options_.json));
  ASSERT_EQ(report["rows"].size(), 10u);
  for (const auto& row : report["rows"]) {
    EXPECT_EQ(row["trace"], "walk");
    const double frames = row["horizon"];
    // 1.5 m/s: 25 mm a frame, which only holding the pose misses. Nothing is predicted across the pause.
    const double expected_mm = row["predictor"] == "hold" ? 25.0 * frames : 0.0;
    EXPECT_NEAR(row["position_mm_mean"], expected_mm, 0.1) << row.dump();
    EXPECT_NEAR(row["position_mm_p99"], expected_mm, 0.1);
    EXPECT_NEAR(row["rotation_deg_p95"], 0.0, 1e-5);
    EXPECT_EQ(row["coverage"], 1.0) << row.dump();
    EXPECT_GE(row["region_mm_mean"], row["position_mm_mean"]);
    // What never turned may begin to: the adaptive predictor allows for it, the others learn from their
    // errors.
    const bool adapts = row["predictor"] == "default" || row["predictor"] == "adaptive";
    EXPECT_NEAR(row["region_deg_mean"], 0.0, adapts ? 2.0 : 1e-4) << row.dump();
  }
}

TEST_F(PredictCommand, CountsPosesOutsideTheAnnouncedRegion) {
  CameraPath path;
  for (int i = 0; i < 600; ++i) {
    const double time_s = i / 60.0;
    // Steady, but for a step of 0.1 m after 5 s that nothing announces.
    path.samples.push_back(
        {time_s, {{0.3 * time_s + (i > 300 ? 0.1 : 0.0), 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}});
  }
  write_camera_path(options_.traces[0], path);
  options_.horizons = {5};
  ASSERT_EQ(run_predict(options_), 0);
  const auto report = nlohmann::json::parse(std::ifstream(options_.json));
  for (const auto& row : report["rows"]) {
    if (row["predictor"] != "default") continue;
    EXPECT_LT(row["coverage"], 1.0);
    EXPECT_GT(row["coverage"], 0.98);
    EXPECT_EQ(row["coverage"], row["position_covered"]);
    EXPECT_EQ(row["rotation_covered"], 1.0);
  }
}

TEST_F(PredictCommand, NamesTheOptionOrFileThatIsWrong) {
  options_.horizons = {0};
  EXPECT_NE(error().find("--horizons"), std::string::npos);
  options_.horizons = {1};
  options_.rate_hz = std::nan("");
  EXPECT_NE(error().find("--rate"), std::string::npos);
  options_.rate_hz = 60.0;
  options_.traces = {folder_ / "missing.csv"};
  EXPECT_NE(error().find("missing.csv"), std::string::npos);
  options_.traces = {};
  EXPECT_NE(error().find("--trace"), std::string::npos);
  SetUp();
  options_.json = folder_ / "no_such_folder" / "predict.json";
  EXPECT_NE(error().find("no_such_folder"), std::string::npos);
}

}  // namespace
}  // namespace sightline
