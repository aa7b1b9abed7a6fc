#pragma once

#include <filesystem>

#include "main_view/app/image.hpp"

namespace sightline {

/// Writes an 8-bit RGB PNG. Throws InputError naming the file when it cannot be written, and leaves no part
/// of it.
void write_png(const std::filesystem::path& file, const Image& image);

}  // namespace sightline
