#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace sightline {

/// 128 bits that both processes compare: equal when geometry, materials, transforms and object order are
/// equal.
using SceneDigest = std::array<std::uint8_t, 16>;

/// 32 lower-case hexadecimal digits.
[[nodiscard]] std::string to_hex(const SceneDigest& digest);

}  // namespace sightline
