#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "protocol/scene_chunks.hpp"

namespace sightline {

/// Room for the bytes of an uploaded scene, aligned for its reader. Copies share it.
class SceneBytes {
 public:
  SceneBytes() = default;
  /// Memory is taken as it is written to, by the page, so an offer of much costs nothing. Empty when there is
  /// none left.
  explicit SceneBytes(std::uint64_t byte_count);

  [[nodiscard]] std::span<std::uint8_t> all() const noexcept { return {bytes_.get(), byte_count_}; }
  /// Requires an index below chunk_count_of() the byte_count.
  [[nodiscard]] std::span<std::uint8_t> chunk(std::uint32_t index) const noexcept {
    return all().subspan(std::size_t{index} * k_scene_chunk_bytes, chunk_of(all(), index).size());
  }
  [[nodiscard]] bool empty() const noexcept { return bytes_ == nullptr; }

 private:
  std::shared_ptr<std::uint8_t[]> bytes_;
  std::uint64_t byte_count_ = 0;
};

}  // namespace sightline
