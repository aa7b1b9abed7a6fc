#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "control_view/engine.hpp"
#include "control_view/engine_thread.hpp"

namespace sightline {

/// What one engine did over all views.
struct EngineTally {
  EngineOptions options;
  double build_s = 0.0;
  std::uint64_t build_bytes = 0;  ///< by which the process grew while the engine was made
  std::vector<double> frame_s;
  EngineStats sums;  ///< times and triangles, over all views
  std::uint64_t drawn_objects = 0;
  std::uint64_t reported = 0;        ///< objects, over all views
  std::uint64_t missed = 0;          ///< visible objects it did not report
  std::uint64_t kept = 0;            ///< hidden objects it reported
  double differing_pixels = 0.0;     ///< see differing_pixels_of
  double pixels = 0.0;               ///< of all views
  std::uint64_t instructions = 0;    ///< over all views
  bool instructions_counted = true;  ///< false once a view's could not be

  /// Takes one answer in, `exact` being what the item buffer shows of the same view of `view_pixels`.
  void add(const EngineThread::TimedStats& timed, const PixelCounts& answer, const PixelCounts& exact,
           double view_pixels);
};

/// Half the sum over objects of the absolute difference of their pixels: a pixel that shows one object
/// instead of another counts once, one that shows an object instead of background (or counts a blended one
/// more) half. Direction of error: too small where differences cancel within an object.
[[nodiscard]] double differing_pixels_of(const PixelCounts& answer, const PixelCounts& exact);

/// `{engine, counter, threads, frame_ms, stages_ms, build_ms, build_mb, drawn_objects, drawn_triangles,
/// reported, missed, kept, differing_pixels_share, instructions}`, means a frame.
[[nodiscard]] nlohmann::json to_json(const EngineTally& tally);

/// `{mean, p50, p99}` in milliseconds.
[[nodiscard]] nlohmann::json milliseconds(const std::vector<double>& seconds);

/// What the process has taken of the machine's memory, bytes: now, and at most so far.
struct MemoryUse {
  std::uint64_t now = 0;
  std::uint64_t peak = 0;
};
[[nodiscard]] MemoryUse memory_use();

/// Processor and number of cores in use, for reports.
[[nodiscard]] nlohmann::json machine_description();

}  // namespace sightline
