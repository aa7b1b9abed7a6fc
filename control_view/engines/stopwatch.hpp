#pragma once

#include <chrono>
#include <utility>

namespace sightline {

/// What an engine books its stages with.
class Stopwatch {
 public:
  /// Seconds since construction or the last lap.
  double lap_s() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }
  /// The same, and no new lap.
  [[nodiscard]] double elapsed_s() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - last_).count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace sightline
