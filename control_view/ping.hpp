#pragma once

#include <string>

#include "common/error.hpp"

namespace sightline {

struct PingOptions {
  std::string endpoint;
  double timeout_s = 2.0;
  std::string keys;
};

/// Whether a daemon answers at the endpoint: `done` or `fell_short`, one line either way. For health checks.
[[nodiscard]] ExitCode ping(const PingOptions& options);

}  // namespace sightline
