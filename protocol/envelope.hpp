#pragma once

#include <cstddef>
#include <span>
#include <variant>

#include "protocol/codec.hpp"

namespace sightline {

namespace wire {
struct Envelope;
}

/// The strictest alignment of any field: a frame is read where it lies, by plain loads.
inline constexpr std::size_t k_frame_alignment = alignof(double);

[[nodiscard]] bool is_aligned(std::span<const std::byte> frame) noexcept;

/// The envelope of a frame, into it, or why it has none: every offset is checked before any is followed.
/// Requires is_aligned(frame), unless it is above max_frame_bytes. What the fields say is not looked at.
[[nodiscard]] std::variant<const wire::Envelope*, DecodeError> verified_envelope(
    std::span<const std::byte> frame, const DecodeLimits& limits);

}  // namespace sightline
