#include "protocol/clean_text.hpp"

#include <cstdint>

namespace sightline {
namespace {

struct Character {
  std::size_t byte_count = 0;  ///< 0: not UTF-8
  bool control = false;
};

/// The character at the front of `text`, which must not be empty. Refuses overlong forms, surrogates and
/// values above U+10FFFF, as RFC 3629 asks.
Character front_character(std::string_view text) noexcept {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::uint8_t lead = byte(0);
  if (lead < 0x80) return {1, lead < 0x20 || lead == 0x7F};

  const std::size_t count = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < count) return {};
  std::uint32_t code = lead & (0xFFu >> (count + 1));
  for (std::size_t i = 1; i < count; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return {};
    code = code << 6 | (byte(i) & 0x3Fu);
  }
  const bool overlong = (count == 3 && code < 0x800) || (count == 4 && code < 0x10000);
  const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
  if (overlong || surrogate || code > 0x10FFFF) return {};
  // C1 controls, and the two separators that some terminals and log readers take for a new line.
  return {count, code < 0xA0 || code == 0x2028 || code == 0x2029};
}

}  // namespace

bool is_clean_text(std::string_view text) noexcept {
  while (!text.empty()) {
    const Character character = front_character(text);
    if (character.byte_count == 0 || character.control) return false;
    text.remove_prefix(character.byte_count);
  }
  return true;
}

std::string clean_text(std::string_view text) {
  std::string clean;
  while (!text.empty()) {
    const Character character = front_character(text);
    const std::size_t taken = character.byte_count == 0 ? 1 : character.byte_count;
    const std::string_view piece = character.byte_count == 0 ? "?"
                                   : character.control       ? " "
                                                             : text.substr(0, taken);
    if (clean.size() + piece.size() > k_max_text_bytes) break;
    clean += piece;
    text.remove_prefix(taken);
  }
  return clean;
}

}  // namespace sightline
