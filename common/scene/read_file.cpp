#include "common/scene/read_file.hpp"

#include <cstdio>
#include <new>
#include <string>
#include <system_error>

#include "common/scene/refuse_scene.hpp"

namespace sightline {

FileBytes read_file(const std::filesystem::path& file, std::uint64_t largest) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) refuse_scene(file.string(), "no such file");
  // A pipe or a device has no size to check its claims against.
  if (!std::filesystem::is_regular_file(status)) refuse_scene(file.string(), "is not a regular file");
  const std::uint64_t size = std::filesystem::file_size(file, error);
  if (error) refuse_scene(file.string(), "cannot be read: " + error.message());
  if (size == 0) refuse_scene(file.string(), "is empty");
  if (size > largest) {
    refuse_scene(file.string(), "is larger than " + std::to_string(largest) + " bytes; split it");
  }
  FileBytes bytes;
  bytes.size = static_cast<std::size_t>(size);
  bytes.data.reset(new std::uint8_t[bytes.size]);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), &std::fclose);
  if (!stream) refuse_scene(file.string(), "cannot be opened; check its permissions");
  if (std::fread(bytes.data.get(), 1, bytes.size, stream.get()) != bytes.size) {
    refuse_scene(file.string(), "ended while it was read");
  }
  return bytes;
}

}  // namespace sightline
