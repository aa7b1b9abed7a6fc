#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>

namespace sightline {

/// Throws InputError now rather than after the run when `file` cannot be written: the file or its folder is
/// read-only, or it is no regular file. A missing folder is not made yet; then the nearest one that exists
/// must be writable. `option` is named in the message.
void require_writable(const std::filesystem::path& file, const char* option);

/// Writes `file` whole or not at all: `write` is handed the name of a file beside it, which then takes its
/// place. Makes missing folders. Throws InputError when that fails, and whatever `write` throws; what was
/// written so far is removed then.
void write_whole(const std::filesystem::path& file,
                 const std::function<void(const std::filesystem::path& partial)>& write);

/// Likewise through a stream.
void write_whole_text(const std::filesystem::path& file, const std::function<void(std::ostream&)>& write);

}  // namespace sightline
