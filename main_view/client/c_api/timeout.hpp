#pragma once

#include <algorithm>

#include "main_view/client/c_api/failure.hpp"

namespace sightline::c_api {

/// A time to wait: any that is not negative; what is longer than thirty years is thirty years. Throws
/// Failure.
[[nodiscard]] inline double checked_timeout_s(double timeout_s) {
  if (!(timeout_s >= 0.0)) fail(SL_ERROR_ARGUMENT, "timeout_s: negative, or no number");
  return std::min(timeout_s, 1e9);
}

}  // namespace sightline::c_api
