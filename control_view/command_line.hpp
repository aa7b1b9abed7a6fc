#pragma once

#include <string>
#include <variant>
#include <vector>

#include "control_view/bench.hpp"
#include "control_view/daemon_options.hpp"
#include "control_view/ping.hpp"

namespace sightline {

struct ServeCommand {
  DaemonOptions options;
  bool die_with_parent = false;
};
struct EnginesCommand {};
struct KeygenCommand {
  std::string file;
};
/// --help and --version.
struct PrintCommand {
  std::string text;
};
using Command =
    std::variant<ServeCommand, EnginesCommand, BenchOptions, PingOptions, KeygenCommand, PrintCommand>;

/// Reads the arguments after the program's name; without a command it is `serve`. For `serve` the preset
/// comes first, the config file on top of it, and what stands on the command line on top of both. Throws
/// InputError, one line.
[[nodiscard]] Command parse_command_line(const std::vector<std::string>& arguments);

}  // namespace sightline
