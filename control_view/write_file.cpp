#include "control_view/write_file.hpp"

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "common/error.hpp"

namespace sightline {
namespace {

std::string temporary_of(const std::string& file) {
  return file + ".part";
}

bool write_text(const std::string& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  return stream.good();
}

[[noreturn]] void refuse(const std::string& file) {
  throw InputError(file + ": cannot be written: choose a file in a folder that exists and is writable");
}

}  // namespace

void write_file(const std::string& file, const std::string& text) {
  const std::string temporary = temporary_of(file);
  if (write_text(temporary, text) && std::rename(temporary.c_str(), file.c_str()) == 0) return;
  std::remove(temporary.c_str());
  refuse(file);
}

void require_writable(const std::string& file) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) refuse(file);
  const std::string temporary = temporary_of(file);
  const bool writable = write_text(temporary, "");
  std::remove(temporary.c_str());
  if (!writable) refuse(file);
}

}  // namespace sightline
