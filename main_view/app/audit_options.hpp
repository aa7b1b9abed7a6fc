#pragma once

#include <filesystem>
#include <optional>

#include "main_view/app/common_options.hpp"
#include "main_view/app/head_motion.hpp"

namespace sightline {

/// `main_view audit`: replays a camera path on a virtual clock through both real processes and counts wrong
/// pixels. service.control_rate_hz is the most requests a VIRTUAL second that the daemon starts (every
/// request when empty); the daemon itself is not told of it, see ServiceOptions::on_virtual_clock.
struct AuditOptions {
  SceneOptions scene;
  ReplayOptions replay;
  ServiceOptions service;
  double latency_ms = 50.0;  ///< virtual time from request to answer
  double lead_in_s = 0.0;    ///< of the path before start_s (where it begins, the camera waits): not judged
  bool still = false;        ///< keeps the camera where it is at replay.start_s
  HeadMotionOptions head;    ///< laid over the path's rotation, also of a still camera
  std::optional<double> max_wrong_pixels;  ///< mean share of a frame's pixels above which the exit code is 1
  std::filesystem::path truth;             ///< see TruthCache; empty for none
  std::filesystem::path frames_csv;        ///< one line a frame; empty for none
  std::filesystem::path json;              ///< report; standard output has the summary either way
};

}  // namespace sightline
