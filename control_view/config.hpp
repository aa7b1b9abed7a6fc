#pragma once

#include <filesystem>

#include "control_view/daemon_options.hpp"

namespace sightline {

/// Reads a TOML file of the keys in daemon_option_fields() on top of `options`; a relative `scene` or `keys`
/// is taken from the file's own folder. Throws InputError naming the file and the key: a missing file, a
/// syntax error, an unknown key, a value of the wrong type or out of range.
void read_config(const std::filesystem::path& file, DaemonOptions& options);

}  // namespace sightline
