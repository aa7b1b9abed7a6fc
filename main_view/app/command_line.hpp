#pragma once

namespace sightline {

/// Everything `main_view` does: parses, runs the command, and turns what went wrong into one line on stderr
/// and an exit code (common/error.hpp). Throws nothing.
[[nodiscard]] int run_command_line(int argc, const char* const* argv) noexcept;

}  // namespace sightline
