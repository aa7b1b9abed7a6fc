#pragma once

#include <filesystem>
#include <optional>

#include "common/error.hpp"
#include "main_view/app/common_options.hpp"

namespace sightline {

/// `main_view judge`: what a client of any language would have drawn along a path, judged as the audit judges
/// (docs/architecture.md, "judge").
struct JudgeOptions {
  SceneOptions scene;
  ReplayOptions replay;
  std::filesystem::path sets;              ///< see read_frame_sets
  std::optional<double> max_wrong_pixels;  ///< mean share of a frame's pixels above which the exit code is 1
  std::filesystem::path truth;             ///< see TruthCache; empty for none
  std::filesystem::path json;              ///< report; standard output has the summary either way
};

/// Returns done, or fell_short when wrong_pixels_mean exceeds options.max_wrong_pixels. Throws InputError and
/// MachineError as the parts it runs do.
[[nodiscard]] ExitCode run_judge(const JudgeOptions& options);

}  // namespace sightline
