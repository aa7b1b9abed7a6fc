#pragma once

#include <chrono>
#include <functional>

namespace sightline {

/// Seconds of a monotonic clock. Handed in, so that a test can turn it.
using Clock = std::function<double()>;

[[nodiscard]] inline Clock steady_clock() {
  return [] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  };
}

}  // namespace sightline
