#pragma once

#include <compare>
#include <cstdint>
#include <limits>

namespace sightline {

/// Index of an object in its scene's object table. Means nothing without that scene's digest.
/// An object is what is culled as a whole: one node with a mesh, or one instance of it.
enum class ObjectId : std::uint32_t {};

/// What an item-buffer pixel holds: 0 is background, an object's code is its id + 1.
using ItemCode = std::uint32_t;
inline constexpr ItemCode k_background_code = 0;

/// One below the largest 32-bit value, so that the code of the last id still fits.
inline constexpr std::uint32_t k_max_object_count = std::numeric_limits<std::uint32_t>::max() - 1;

[[nodiscard]] constexpr std::uint32_t index_of(ObjectId id) noexcept {
  return static_cast<std::uint32_t>(id);
}
[[nodiscard]] constexpr ItemCode code_of(ObjectId id) noexcept {
  return index_of(id) + 1;
}
/// Requires code != k_background_code.
[[nodiscard]] constexpr ObjectId object_of(ItemCode code) noexcept {
  return ObjectId{code - 1};
}

}  // namespace sightline
