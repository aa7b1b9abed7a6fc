#pragma once

#include <string_view>

#include "common/error.hpp"
#include "main_view/app/view_options.hpp"

namespace sightline {

/// "shaded", "item_buffer" or "depth_complexity"; throws InputError for another word, naming the choices.
[[nodiscard]] Picture parse_picture(std::string_view text);

/// Opens the window and runs until it is closed (or options.frames have been drawn).
/// Throws InputError for the scene, path or daemon, MachineError where there is no display.
ExitCode run_view(const ViewOptions& options);

}  // namespace sightline
