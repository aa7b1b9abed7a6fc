#pragma once

#include "common/error.hpp"
#include "main_view/app/audit_options.hpp"

namespace sightline {

/// Replays a camera path on a virtual clock through this process and a real daemon, judges every frame
/// against the whole scene and writes the report (docs/architecture.md, "The audit"). Returns done, or
/// fell_short when wrong_pixels_mean exceeds options.max_wrong_pixels. Throws InputError and MachineError as
/// the parts it runs do.
[[nodiscard]] ExitCode run_audit(const AuditOptions& options);

}  // namespace sightline
