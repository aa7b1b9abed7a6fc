#pragma once

#include <filesystem>

#include <tiny_gltf.h>

namespace sightline {

/// Parses a glTF file with tinygltf into its tables; no accessor, view or node has been checked yet. Images
/// stay encoded: those of a uri in Image::image, those of a buffer view in their buffer.
///
/// External buffers and images are read only from the file's own folder and below. Throws InputError, one
/// line that begins with the file's name.
[[nodiscard]] tinygltf::Model parse_gltf(const std::filesystem::path& file);

}  // namespace sightline
