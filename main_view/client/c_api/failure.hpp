#pragma once

#include <string>
#include <utility>

#include "main_view/client/c_api/sightline.h"

namespace sightline::c_api {

/// Why a call cannot be done. Thrown inside the library, caught at its border.
struct Failure {
  sl_status status = SL_ERROR_INTERNAL;
  std::string text;
};

[[noreturn]] inline void fail(sl_status status, std::string text) {
  throw Failure{status, std::move(text)};
}

/// Notes for the calling thread that a call with `handle` failed. Cuts the text where it is too long; never
/// allocates.
void note_failure(const void* handle, const char* text) noexcept;

/// The status and text of the exception that is being handled.
sl_status note_current_exception(const void* handle) noexcept;

/// Runs the body of a call: whatever it throws becomes a status. `body` returns a status of its own.
template <typename Body>
sl_status guarded(const void* handle, Body&& body) noexcept {
  try {
    const sl_status status = body();
    if (status < 0) note_failure(handle, sl_status_text(status));
    return status;
  } catch (...) {
    return note_current_exception(handle);
  }
}

}  // namespace sightline::c_api
