#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/view.hpp"

namespace sightline::raster {

/// Cuts a view into upright strips, one a worker, and moves the cuts so that all take about equally long next
/// time.
///
/// Each strip is drawn by itself from the first test to the last count, so workers wait for each other once a
/// frame only. What it costs is that objects across a cut are tested and transformed twice. Counts do not
/// depend on where the cuts are.
class Strips {
 public:
  explicit Strips(std::size_t count) : ends_(count), times_s_(count, 0.0) {}

  /// Cuts for an image; those of the last frame, moved, where it had the same width.
  void cut(std::int32_t width);
  [[nodiscard]] std::size_t count() const noexcept { return ends_.size(); }
  [[nodiscard]] std::int32_t begin_of(std::size_t strip) const noexcept {
    return strip == 0 ? 0 : ends_[strip - 1];
  }
  [[nodiscard]] std::int32_t end_of(std::size_t strip) const noexcept { return ends_[strip]; }
  void note_time(std::size_t strip, double time_s) noexcept { times_s_[strip] = time_s; }

 private:
  void balance();

  std::int32_t width_ = 0;
  std::vector<std::int32_t> ends_, moved_;
  std::vector<double> times_s_;
};

}  // namespace sightline::raster
