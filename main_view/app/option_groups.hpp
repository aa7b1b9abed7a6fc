#pragma once

#include <CLI/CLI.hpp>

#include "main_view/app/common_options.hpp"

namespace sightline {

/// The options that several commands share. Each adds them to `command` and stores what is given in
/// `options`, which must outlive the parse. A value that cannot be read throws InputError naming the option.
void add_scene_options(CLI::App& command, SceneOptions& options, bool path_required);
void add_replay_options(CLI::App& command, ReplayOptions& options);
void add_service_options(CLI::App& command, ServiceOptions& options);

/// "WxH" of the option `name`.
[[nodiscard]] ImageSize size_argument(const char* name, const std::string& text);

}  // namespace sightline
