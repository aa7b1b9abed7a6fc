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
  service.engine.reset();
  service.control_size = ImageSize{1024, 768};
  EXPECT_NE(refusal([&] { require_settings(service, daemon); }).find("--control-size"), std::string::npos);
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
