#pragma once

#include "common/error.hpp"
#include "main_view/app/play_options.hpp"

namespace sightline {

/// Replays a camera path and measures it: frame times with the culling asked for and, frame by frame over the
/// same poses, with those to compare with. Writes report.json, frames.csv, the image set and the frame-time
/// plot to `out`.
///
/// Every frame of the path is drawn, none is skipped, so that runs compare frame by frame; where drawing is
/// slower than
/// --rate the camera moves in slow motion. Cullings take turns in blocks of k_block_frames, each after a few
/// frames of warm-up that are not measured, so that a machine whose speed drifts favours none.
[[nodiscard]] ExitCode run_play(const PlayOptions& options);

}  // namespace sightline
