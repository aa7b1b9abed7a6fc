#pragma once

#include <string>

namespace sightline {

/// Writes a whole file or none: to a temporary beside it, which then takes its name.
/// Throws InputError naming the file when that cannot be done.
void write_file(const std::string& file, const std::string& text);

/// Throws what write_file would throw, and leaves what `file` holds alone: to know before long work.
void require_writable(const std::string& file);

}  // namespace sightline
