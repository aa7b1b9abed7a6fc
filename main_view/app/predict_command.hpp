#pragma once

#include <filesystem>
#include <vector>

namespace sightline {

/// `main_view predict`: how far off motion predictors are on recorded camera motion.
struct PredictOptions {
  std::vector<std::filesystem::path> traces;   ///< camera path CSVs, at least one
  double rate_hz = 60.0;                       ///< traces are resampled to this, 1 to 1000
  std::vector<int> horizons{1, 2, 5, 10, 20};  ///< frames ahead, each 1 to 600
  std::filesystem::path json;                  ///< report to write
};

/// Replays each trace, split where it pauses for more than 0.1 s, and writes `rows` to options.json: for each
/// trace, horizon and predictor the errors; `coverage`, the share of poses that lay in the announced region,
/// and `position_covered` and `rotation_covered`, in its position's and its rotation's part; and the region's
/// mean radii, `region_mm_mean` and `region_deg_mean`. The first 20 poses after a pause are
/// not counted. Prints the mean errors relative to the paper's predictor. Returns an exit code. Throws
/// InputError naming the option or file that is wrong.
int run_predict(const PredictOptions& options);

}  // namespace sightline
