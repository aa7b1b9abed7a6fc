#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "control_view/engine.hpp"

namespace sightline {

/// What one engine did over all views.
struct EngineTally {
  EngineOptions options;
  std::vector<double> frame_s;
  EngineStats sums;  ///< times and triangles, over all views
  std::uint64_t drawn_objects = 0;
  std::uint64_t reported = 0;  ///< objects, over all views
  std::uint64_t missed = 0;    ///< visible objects it did not report
  std::uint64_t kept = 0;      ///< hidden objects it reported

  /// Takes one answer in, `exact` being what the item buffer shows of the same view.
  void add(double frame_time_s, const EngineStats& stats, const PixelCounts& answer,
           const PixelCounts& exact);
};

/// `{engine, counter, frame_ms, stages_ms, drawn_objects, drawn_triangles, reported, missed, kept}`, means a
/// frame.
[[nodiscard]] nlohmann::json to_json(const EngineTally& tally);

/// Processor and number of cores in use, for reports.
[[nodiscard]] nlohmann::json machine_description();

}  // namespace sightline
