#pragma once

#include "control_view/daemon_options.hpp"

namespace sightline {

/// Serves until SIGINT or SIGTERM. When ready, one line on stdout:
/// `control_view: listening on tcp://127.0.0.1:40123` (wildcard port resolved).
/// Throws InputError and MachineError.
void serve(const DaemonOptions& options);

}  // namespace sightline
