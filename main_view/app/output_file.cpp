#include "main_view/app/output_file.hpp"

#include <fstream>
#include <string>
#include <system_error>

#include <unistd.h>

#include "common/error.hpp"

namespace sightline {
namespace {

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

std::filesystem::path nearest_existing(std::filesystem::path folder) {
  std::error_code error;
  while (!std::filesystem::exists(folder, error)) {
    const std::filesystem::path above = folder_of(folder);
    if (above == folder) break;
    folder = above;
  }
  return folder;
}

}  // namespace

void require_writable(const std::filesystem::path& file, const char* option) {
  std::error_code error;
  const std::filesystem::path folder = nearest_existing(folder_of(file));
  const bool folder_serves =
      std::filesystem::is_directory(folder, error) && access(folder.c_str(), W_OK | X_OK) == 0;
  // Renaming onto a device or a folder would replace it.
  const bool file_serves = !std::filesystem::exists(file, error) ||
                           (std::filesystem::is_regular_file(file, error) && access(file.c_str(), W_OK) == 0);
  if (file.has_filename() && folder_serves && file_serves) return;
  throw InputError(std::string(option) + " " + file.string() +
                   ": name a file in a folder that can be written");
}

void write_whole(const std::filesystem::path& file,
                 const std::function<void(const std::filesystem::path& partial)>& write) {
  const std::filesystem::path partial = file.string() + ".partial";
  std::error_code error;
  std::filesystem::create_directories(folder_of(file), error);
  if (error) throw InputError(file.string() + ": its folder cannot be made: " + error.message());
  try {
    write(partial);
    std::filesystem::rename(partial, file, error);
    if (error) throw InputError(file.string() + ": cannot be written: " + error.message());
  } catch (...) {
    std::filesystem::remove(partial, error);
    throw;
  }
}

void write_whole_text(const std::filesystem::path& file, const std::function<void(std::ostream&)>& write) {
  write_whole(file, [&](const std::filesystem::path& partial) {
    std::ofstream out(partial);
    write(out);
    if (!out.flush())
      throw InputError(file.string() + ": cannot be written; check the folder and its rights");
  });
}

}  // namespace sightline
