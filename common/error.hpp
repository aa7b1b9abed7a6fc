#pragma once

#include <stdexcept>
#include <string>

namespace sightline {

/// Exit codes of both executables.
enum class ExitCode : int {
  done = 0,
  fell_short = 1,     ///< it ran, and what it checks fell short
  bad_input = 2,      ///< unusable arguments or input
  machine_failed = 3  ///< no GL context, endpoint in use, out of memory
};

/// Unusable arguments or input. The text is one line that names the file or field and says what to do.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The machine could not do what was asked. The text is one line that names the failing call or endpoint.
class MachineError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace sightline
