#include "main_view/app/predict_command.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "common/camera_path.hpp"
#include "common/error.hpp"
#include "common/statistics.hpp"
#include "main_view/client/motion_predictor.hpp"

namespace sightline {
namespace {

constexpr double k_longest_gap_s = 0.1;
constexpr int k_longest_horizon = 600;
// Before it the paper's window is not full, and the predictors would not be compared on their own terms.
constexpr std::size_t k_warm_up = 20;

struct Predictor {
  const char* name;
  CullingOptions options;
};

CullingOptions fixed(int order, int window) {
  CullingOptions options;
  options.predictor = PredictorKind::fixed;
  options.predictor_order = order;
  options.predictor_window = window;
  return options;
}

CullingOptions adaptive() {
  CullingOptions options;
  options.predictor = PredictorKind::adaptive;
  return options;
}

std::vector<Predictor> predictors() {
  return {{"avango", fixed(2, 20)},
          {"constant_velocity", fixed(1, 2)},
          {"hold", fixed(0, 1)},
          {"adaptive", adaptive()},
          {"default", CullingOptions{}}};
}

using Segment = std::vector<TimedPose>;

/// The stretches between pauses, resampled to a steady rate.
std::vector<Segment> steady_segments(const CameraPath& trace, double rate_hz) {
  std::vector<Segment> segments;
  for (const CameraPath& stretch : pieces_between_gaps(trace, k_longest_gap_s)) {
    const double start_s = stretch.samples.front().time_s;
    Segment segment;
    for (std::size_t i = 0;; ++i) {
      const double time_s = start_s + static_cast<double>(i) / rate_hz;
      if (time_s > stretch.samples.back().time_s) break;
      segment.push_back({time_s, stretch.at(time_s)});
    }
    segments.push_back(std::move(segment));
  }
  return segments;
}

struct Errors {
  std::vector<double> position_mm;
  std::vector<double> rotation_deg;
  std::vector<double> region_mm;
  std::vector<double> region_deg;
  std::size_t position_covered = 0;
  std::size_t rotation_covered = 0;
  std::size_t covered = 0;  ///< both at once
};

void add_outcome(const PredictedPose& predicted, const Pose& truth, Errors& errors) {
  constexpr double k_degrees = 180.0 / 3.141592653589793;
  const double position_m = glm::length(predicted.pose.position_m - truth.position_m);
  const double rotation_rad = rotation_angle_rad(predicted.pose.world_from_camera, truth.world_from_camera);
  errors.position_mm.push_back(1000.0 * position_m);
  errors.rotation_deg.push_back(k_degrees * rotation_rad);
  errors.region_mm.push_back(1000.0 * predicted.position_error_m);
  errors.region_deg.push_back(k_degrees * predicted.rotation_error_rad);
  // Below a nanometre and its like it is rounding, of a camera that stands still.
  const bool position_covered = position_m <= predicted.position_error_m + 1e-9;
  const bool rotation_covered = rotation_rad <= predicted.rotation_error_rad + 1e-7;
  errors.position_covered += position_covered;
  errors.rotation_covered += rotation_covered;
  errors.covered += position_covered && rotation_covered;
}

/// One session a trace: what a predictor learns outlives the pauses, the poses do not.
Errors predict_trace(const std::vector<Segment>& segments, const CullingOptions& options,
                     std::size_t horizon) {
  Errors errors;
  PoseHistory history(options);
  MotionPredictor predictor(options);
  for (const Segment& segment : segments) {
    history.clear();
    predictor.forget_pending();
    for (std::size_t i = 0; i + horizon < segment.size(); ++i) {
      if (history.add(segment[i]) == PoseHistory::Added::jumped) predictor.forget_pending();
      predictor.observe(history);
      const TimedPose& truth = segment[i + horizon];
      const PredictedPose predicted = predictor.predict(history, truth.time_s);
      if (i + 1 >= k_warm_up) add_outcome(predicted, truth.pose, errors);
    }
  }
  return errors;
}

nlohmann::json row_of(const std::string& trace, int horizon, const Predictor& predictor,
                      const Errors& errors) {
  const double count = static_cast<double>(std::max<std::size_t>(errors.position_mm.size(), 1));
  return {{"trace", trace},
          {"horizon", horizon},
          {"predictor", predictor.name},
          {"predictions", errors.position_mm.size()},
          {"position_mm_mean", mean_of(errors.position_mm)},
          {"position_mm_p95", quantile_of(errors.position_mm, 0.95)},
          {"position_mm_p99", quantile_of(errors.position_mm, 0.99)},
          {"rotation_deg_mean", mean_of(errors.rotation_deg)},
          {"rotation_deg_p95", quantile_of(errors.rotation_deg, 0.95)},
          {"rotation_deg_p99", quantile_of(errors.rotation_deg, 0.99)},
          {"coverage", static_cast<double>(errors.covered) / count},
          {"region_mm_mean", mean_of(errors.region_mm)},
          {"region_deg_mean", mean_of(errors.region_deg)},
          {"position_covered", static_cast<double>(errors.position_covered) / count},
          {"rotation_covered", static_cast<double>(errors.rotation_covered) / count}};
}

void require_usable(const PredictOptions& options) {
  if (options.traces.empty()) throw InputError("--trace is missing: give at least one CSV");
  if (!(options.rate_hz >= 1.0 && options.rate_hz <= 1000.0)) {
    throw InputError("--rate is " + std::to_string(options.rate_hz) + ": give 1 to 1000 Hz");
  }
  if (options.horizons.empty()) throw InputError("--horizons is empty: give frames ahead, for example 1,2,5");
  for (const int horizon : options.horizons) {
    if (horizon >= 1 && horizon <= k_longest_horizon) continue;
    throw InputError("--horizons has " + std::to_string(horizon) + ": give 1 to " +
                     std::to_string(k_longest_horizon) + " frames");
  }
}

/// Each predictor's mean error over the paper's; geometric mean over the traces, as they are ratios. Then how
/// often, on the trace where it was least often, the truth lay in the announced region.
void print_summary(const nlohmann::json& rows, const PredictOptions& options) {
  std::printf(
      "mean error relative to avango (order 2 over 20 poses); geometric mean of the traces, smaller is "
      "better\n");
  for (const char* field : {"position_mm_mean", "rotation_deg_mean"}) {
    for (const Predictor& predictor : predictors()) {
      std::printf("%-18s %-18s", field, predictor.name);
      for (const int horizon : options.horizons) {
        std::map<std::string, double> own;
        std::map<std::string, double> papers;
        for (const auto& row : rows) {
          if (row["horizon"] != horizon) continue;
          if (row["predictor"] == predictor.name) own[row["trace"]] = row[field];
          if (row["predictor"] == "avango") papers[row["trace"]] = row[field];
        }
        std::vector<double> logarithms;
        for (const auto& [trace, error] : own) {
          if (error > 1e-6 && papers[trace] > 1e-6) logarithms.push_back(std::log(error / papers[trace]));
        }
        std::printf("  k=%-3d %5.2f", horizon, std::exp(mean_of(logarithms)));
      }
      std::printf("\n");
    }
  }
  for (const Predictor& predictor : predictors()) {
    std::printf("%-18s %-18s", "least coverage", predictor.name);
    for (const int horizon : options.horizons) {
      double least = 1.0;
      for (const auto& row : rows) {
        if (row["horizon"] == horizon && row["predictor"] == predictor.name)
          least = std::min(least, row["coverage"].get<double>());
      }
      std::printf("  k=%-3d %5.4f", horizon, least);
    }
    std::printf("\n");
  }
}

}  // namespace

int run_predict(const PredictOptions& options) {
  require_usable(options);
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& file : options.traces) {
    const auto segments = steady_segments(read_camera_path(file), options.rate_hz);
    for (const int horizon : options.horizons) {
      for (const Predictor& predictor : predictors()) {
        const Errors errors = predict_trace(segments, predictor.options, static_cast<std::size_t>(horizon));
        rows.push_back(row_of(file.stem().string(), horizon, predictor, errors));
      }
    }
  }
  std::ofstream out(options.json);
  out << nlohmann::json{{"rate_hz", options.rate_hz}, {"rows", rows}}.dump(2) << '\n';
  if (!out.flush())
    throw InputError("--json " + options.json.string() +
                     " cannot be written: give a file in an existing folder");
  print_summary(rows, options);
  return static_cast<int>(ExitCode::done);
}

}  // namespace sightline
