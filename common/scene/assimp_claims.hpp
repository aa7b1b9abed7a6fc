#pragma once

#include <filesystem>

namespace sightline {

/// Refuses (InputError, prefixed with the file's name) a PLY or binary STL file whose header counts more
/// elements than its bytes can hold. Assimp allocates what these two headers count before it reads an
/// element.
///
/// Judged by content, whatever the extension, as assimp may: a file that is neither passes. In a PLY an
/// element needs the bytes of its binary properties (a list those of its count), or two characters a property
/// in ASCII; a list's own count is not checked.
void refuse_impossible_counts(const std::filesystem::path& file);

}  // namespace sightline
