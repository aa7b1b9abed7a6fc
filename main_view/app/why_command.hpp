#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

#include "common/error.hpp"
#include "main_view/app/common_options.hpp"

namespace sightline {

/// `main_view why`: asks the daemon why an object is in, or not in, what one frame of a path draws.
struct WhyOptions {
  SceneOptions scene;
  ReplayOptions replay;
  ServiceOptions service;
  std::uint32_t frame = 0;  ///< of the path at replay.rate_hz, counted from replay.start_s
  std::string object;       ///< id or name
};

/// Frames before the one asked about that the daemon sees too, so that its filter is as full as in service.
inline constexpr std::uint32_t k_why_lead_frames = 15;

/// Replays the frames up to options.frame, waiting for each answer, asks, and prints one fact a line: a word
/// and what there is to say. Throws InputError for the scene, path, object or daemon's refusal, MachineError
/// when the daemon does not answer.
ExitCode run_why(const WhyOptions& options, std::ostream& out);

}  // namespace sightline
