#pragma once

#include <cstdint>
#include <vector>

#include "common/object_id.hpp"

namespace sightline {

/// A bit an object: bit i % 64 of word i / 64 is object i.
using ObjectBits = std::vector<std::uint64_t>;

[[nodiscard]] constexpr std::size_t word_count_of(std::uint32_t object_count) noexcept {
  return (std::size_t{object_count} + 63) / 64;
}
[[nodiscard]] inline bool test_bit(const ObjectBits& bits, ObjectId id) noexcept {
  return (bits[index_of(id) >> 6] >> (index_of(id) & 63) & 1u) != 0;
}
inline void set_bit(ObjectBits& bits, ObjectId id, bool value = true) noexcept {
  const std::uint64_t bit = std::uint64_t{1} << (index_of(id) & 63);
  std::uint64_t& word = bits[index_of(id) >> 6];
  word = value ? word | bit : word & ~bit;
}

}  // namespace sightline
