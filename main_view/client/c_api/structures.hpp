#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

#include "main_view/client/c_api/failure.hpp"

namespace sightline::c_api {

/// Larger than any structure will be: what is beyond is no size.
inline constexpr std::uint32_t k_largest_structure = 1u << 16;

[[noreturn]] inline void fail_of_size(const char* name, std::uint32_t size, std::size_t right) {
  fail(SL_ERROR_STRUCT_SIZE, std::string(name) + ".struct_size: " + std::to_string(size) +
                                 "; set it to sizeof(" + name + "), here " + std::to_string(right));
}

/// A caller's structure as this library knows it: fields beyond its struct_size are zero. `name` is for the
/// text of a Failure. `least` is the size in the first version that had the structure.
template <typename Structure>
[[nodiscard]] Structure read_structure(const Structure* given, const char* name,
                                       std::uint32_t least = sizeof(Structure)) {
  static_assert(std::is_trivially_copyable_v<Structure>);
  if (given == nullptr) fail(SL_ERROR_ARGUMENT, std::string(name) + ": null");
  std::uint32_t size = 0;
  std::memcpy(&size, given, sizeof size);
  if (size < least || size > k_largest_structure) fail_of_size(name, size, sizeof(Structure));
  const auto* bytes = reinterpret_cast<const unsigned char*>(given);
  const auto* end = bytes + size;
  if (size > sizeof(Structure) &&
      std::any_of(bytes + sizeof(Structure), end, [](unsigned char byte) { return byte != 0; })) {
    fail(SL_ERROR_STRUCT_SIZE, std::string(name) + ": sets fields that this libsightline does not know");
  }
  Structure known{};
  std::memcpy(&known, given, std::min<std::size_t>(size, sizeof known));
  return known;
}

/// Throws Failure unless a caller's structure can be filled. Returns its size.
template <typename Structure>
std::uint32_t require_writable(const Structure* given, const char* name,
                               std::uint32_t least = sizeof(Structure)) {
  if (given == nullptr) fail(SL_ERROR_ARGUMENT, std::string(name) + ": null");
  std::uint32_t size = 0;
  std::memcpy(&size, given, sizeof size);
  if (size < least || size > k_largest_structure) fail_of_size(name, size, sizeof(Structure));
  return size;
}

/// Fills a caller's structure as far as it reaches; its struct_size stays.
template <typename Structure>
void write_structure(Structure* given, const Structure& filled, const char* name,
                     std::uint32_t least = sizeof(Structure)) {
  static_assert(std::is_trivially_copyable_v<Structure>);
  const std::uint32_t size = require_writable(given, name, least);
  std::memcpy(given, &filled, std::min<std::size_t>(size, sizeof filled));
  std::memcpy(given, &size, sizeof size);
}

/// Copies text into a field, cut where it is too long, with its final zero.
template <std::size_t capacity>
void write_text(char (&field)[capacity], const std::string& text) noexcept {
  const std::size_t size = std::min(text.size(), capacity - 1);
  std::memcpy(field, text.data(), size);
  field[size] = '\0';
}

}  // namespace sightline::c_api
