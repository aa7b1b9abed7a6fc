#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "protocol/messages.hpp"

namespace sightline {

using Bytes = std::vector<std::byte>;

/// Limits that a frame is checked against before anything is allocated for it.
struct DecodeLimits {
  std::size_t max_frame_bytes = 64u << 20;
  std::size_t max_text_bytes = 1024;
  std::size_t max_moves = 1u << 20;  ///< and boxed objects, and changes of presence
};

/// Why a frame was refused, one line.
struct DecodeError {
  std::string reason;
};

/// One FlatBuffers frame (file identifier "SLN1") for any message.
[[nodiscard]] Bytes encode(const Message& message);

/// Safe on untrusted bytes: verified before any field is read, every count checked against `limits` before
/// any allocation, every number checked (matrices finite, sizes within k_max_image_side, 1..k_max_eyes eyes).
/// Returns the message or the first reason it was refused; throws only bad_alloc.
[[nodiscard]] std::variant<Message, DecodeError> decode(std::span<const std::byte> frame,
                                                        const DecodeLimits& limits = {});

}  // namespace sightline
