#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "main_view/app/common_options.hpp"
#include "main_view/app/output_file.hpp"  // require_writable, for who writes reports
#include "main_view/client/culling_session.hpp"

namespace sightline {

/// What every report begins with: the command line, the version and the machine (processor, cores, system).
[[nodiscard]] nlohmann::ordered_json report_header(const std::string& gl_description);

/// The settings in force: the camera, the replay and, where there is a daemon, its own as its Welcome tells
/// them.
[[nodiscard]] nlohmann::ordered_json settings_of(const SceneOptions& scene, const ReplayOptions& replay,
                                                 const CullingOptions& culling, const ServiceOptions& service,
                                                 const std::optional<Welcome>& daemon);

/// Writes indented JSON, whole or not at all (through a file beside it). Throws InputError naming the file.
void write_report(const std::filesystem::path& file, const nlohmann::ordered_json& report);

}  // namespace sightline
