#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace sightline {

/// Longest text that `encode` writes, bytes; what DecodeLimits allows by default.
inline constexpr std::size_t k_max_text_bytes = 1024;

/// Whether `text` is well-formed UTF-8 without control characters, so that it can go to a log or a terminal.
[[nodiscard]] bool is_clean_text(std::string_view text) noexcept;

/// `text` made clean: control characters become spaces, bytes that are no UTF-8 become '?', and what is over
/// k_max_text_bytes is cut off between two characters.
[[nodiscard]] std::string clean_text(std::string_view text);

}  // namespace sightline
