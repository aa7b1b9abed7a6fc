#include "main_view/app/common_options.hpp"

#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "common/error.hpp"

namespace sightline {
namespace {

std::string refusal(const std::function<void()>& validate) {
  try {
    validate();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ReplayOptions, CountsTheLastSampleOfAPath) {
  ReplayOptions replay;
  EXPECT_EQ(replay.frame_count(0.0), 1u);
  EXPECT_EQ(replay.frame_count(59.9833333333), 3600u);
  EXPECT_EQ(replay.frame_count(60.0), 3601u);
  replay.frames = 10;
  EXPECT_EQ(replay.frame_count(60.0), 10u);
  replay.frames = 100;
  replay.start_s = 59.5;
  EXPECT_EQ(replay.frame_count(60.0), 31u);
  replay.start_s = 60.5;
  EXPECT_NE(refusal([&] { (void)replay.frame_count(60.0); }).find("--start"), std::string::npos);
}

TEST(ReplayOptions, RefusesRatesThatAreNone) {
  for (const double rate : {0.0, -1.0, 1e9, std::nan(""), std::numeric_limits<double>::infinity()}) {
    ReplayOptions replay;
    replay.rate_hz = rate;
    EXPECT_NE(refusal([&] { replay.validate(); }).find("--rate"), std::string::npos) << rate;
  }
}

TEST(SceneOptions, RefusesLensesThatSeeNothing) {
  SceneOptions scene;
  EXPECT_EQ(refusal([&] { scene.validate(); }), "");
  scene.near_m = 0.0;
  EXPECT_NE(refusal([&] { scene.validate(); }).find("--near"), std::string::npos);
  scene = {};
  scene.far_m = 0.05;
  EXPECT_NE(refusal([&] { scene.validate(); }).find("--far"), std::string::npos);
  scene = {};
  scene.vertical_fov_deg = 180.0;
  EXPECT_NE(refusal([&] { scene.validate(); }).find("--fov"), std::string::npos);
}

TEST(ServiceOptions, NeedsOneDaemonAndNotTwo) {
  ServiceOptions service;
  EXPECT_EQ(refusal([&] { service.validate(false); }), "");
  EXPECT_NE(refusal([&] { service.validate(true); }).find("--spawn"), std::string::npos);
  service.spawn = true;
  EXPECT_EQ(refusal([&] { service.validate(true); }), "");
  service.connect = "tcp://127.0.0.1:1";
  EXPECT_NE(refusal([&] { service.validate(true); }).find("--connect"), std::string::npos);
}

TEST(ServiceOptions, DemandsItsSettingsOfARunningDaemon) {
  Welcome daemon;
  daemon.engine = "item_buffer";
  daemon.control_size = {512, 384};
  daemon.filter_length = 8;
  ServiceOptions service;
  service.engine = "item_buffer";
  service.filter = 8;
  service.control_size = ImageSize{512, 384};
  EXPECT_EQ(refusal([&] { require_settings(service, daemon); }), "");
  service.filter = 1;
  EXPECT_NE(refusal([&] { require_settings(service, daemon); }).find("--filter"), std::string::npos);
  service.filter.reset();
  service.engine = "other";
  EXPECT_NE(refusal([&] { require_settings(service, daemon); }).find("--engine"), std::string::npos);
  service.engine = "auto";
  EXPECT_EQ(refusal([&] { require_settings(service, daemon); }), "") << "any engine is what auto asks for";
  service.engine.reset();
  service.control_size = ImageSize{1024, 768};
  EXPECT_NE(refusal([&] { require_settings(service, daemon); }).find("--control-size"), std::string::npos);
}

TEST(ServiceOptions, DemandsCounterThresholdPresetAndRateToo) {
  Welcome daemon;
  daemon.engine = "item_buffer/histogram";
  daemon.counter = "histogram";
  daemon.threshold = 0.25;
  daemon.preset = "avango";
  daemon.control_rate_hz = 30.0;
  ServiceOptions same;
  same.connect = "tcp://127.0.0.1:1";
  same.engine = "item_buffer";
  same.counter = daemon.counter;
  same.threshold = daemon.threshold;
  same.preset = daemon.preset;
  same.control_rate_hz = daemon.control_rate_hz;
  EXPECT_EQ(refusal([&] { same.validate(true); }), "");
  EXPECT_EQ(refusal([&] { require_settings(same, daemon); }), "");

  const auto refused = [&](const char* option, const std::function<void(ServiceOptions&)>& change) {
    ServiceOptions other = same;
    change(other);
    EXPECT_NE(refusal([&] { require_settings(other, daemon); }).find(option), std::string::npos) << option;
  };
  refused("--engine", [](ServiceOptions& o) { o.engine = "item"; });
  refused("--counter", [](ServiceOptions& o) { o.counter = "queries"; });
  refused("--threshold", [](ServiceOptions& o) { o.threshold = 0.5; });
  refused("--preset", [](ServiceOptions& o) { o.preset = "default"; });
  refused("--control-rate", [](ServiceOptions& o) { o.control_rate_hz = 15.0; });
}

TEST(ServiceOptions, TakesKeysForADaemonThatRunsOnly) {
  ServiceOptions service;
  service.key_file = "keys.toml";
  service.connect = "tcp://127.0.0.1:1";
  EXPECT_EQ(refusal([&] { service.validate(true); }), "");
  service.connect.clear();
  service.spawn = true;
  EXPECT_NE(refusal([&] { service.validate(true); }).find("--keys"), std::string::npos);
}

TEST(ServiceOptions, HandsNumbersOnToTheLastDigit) {
  for (const double value : {0.0, 1e-7, 0.1, 1.0 / 3.0, 1e300}) EXPECT_EQ(std::stod(digits_of(value)), value);
  ServiceOptions service;
  service.threshold = 1e-7;
  service.control_rate_hz = 30.0;
  const ServiceOptions virtual_clock = service.on_virtual_clock();
  EXPECT_EQ(virtual_clock.threshold, 1e-7);
  EXPECT_FALSE(virtual_clock.control_rate_hz);
}

TEST(CullingMode, ReadsItsOwnNames) {
  for (const CullingMode mode :
       {CullingMode::none, CullingMode::frustum, CullingMode::service, CullingMode::oracle}) {
    EXPECT_EQ(parse_culling_mode(to_string(mode)), mode);
  }
  EXPECT_THROW((void)parse_culling_mode("Frustum"), InputError);
}

}  // namespace
}  // namespace sightline
