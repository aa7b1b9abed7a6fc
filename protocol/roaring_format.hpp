#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "protocol/codec.hpp"

namespace sightline {

/// What a well-formed bitmap holds.
struct RoaringSummary {
  std::uint64_t cardinality = 0;
  std::uint32_t largest = 0;  ///< 0 when it is empty
};

/// Checks a whole bitmap in Roaring's portable format (github.com/RoaringBitmap/RoaringFormatSpec) without
/// allocating: cookie, keys, offsets, every container's order and cardinality, and that nothing follows.
/// What passes is safe for CRoaring, whose own reader checks lengths only and trusts order and cardinality.
/// Stricter than the specification in three points, all of which every known writer keeps: offsets must be
/// where the containers are, runs that touch must be one run, and unused flag bits must be zero.
[[nodiscard]] std::variant<RoaringSummary, DecodeError> check_roaring(std::span<const std::uint8_t> bytes);

}  // namespace sightline
