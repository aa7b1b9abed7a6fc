#pragma once

#include <filesystem>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "main_view/app/play_run.hpp"

namespace sightline {

/// The report's `timing`: the first run's frame milliseconds, every run's under `runs`, acceleration of the
/// first against the others, and the service's round trip, stages and bytes where it took part.
[[nodiscard]] nlohmann::ordered_json timing_of(const std::vector<PlayRun>& runs,
                                               const ServiceTiming& service);

/// One line a frame: frame, then milliseconds, objects and triangles of each run.
void write_frames_csv(const std::filesystem::path& file, const std::vector<PlayRun>& runs);

}  // namespace sightline
