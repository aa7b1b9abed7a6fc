#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

namespace sightline {

/// A whole file in memory, not zeroed first.
struct FileBytes {
  std::unique_ptr<std::uint8_t[]> data;
  std::size_t size = 0;

  [[nodiscard]] std::span<const std::uint8_t> span() const noexcept { return {data.get(), size}; }
};

/// Throws InputError naming the file when it is missing, no regular file, empty, larger than `largest` bytes
/// or shrinks while it is read.
[[nodiscard]] FileBytes read_file(const std::filesystem::path& file, std::uint64_t largest);

}  // namespace sightline
