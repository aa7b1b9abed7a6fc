#include "common/scene_digest.hpp"

namespace sightline {

std::string to_hex(const SceneDigest& digest) {
  constexpr char k_digits[] = "0123456789abcdef";
  std::string text;
  text.reserve(2 * digest.size());
  for (const std::uint8_t byte : digest) {
    text += k_digits[byte >> 4];
    text += k_digits[byte & 15];
  }
  return text;
}

}  // namespace sightline
