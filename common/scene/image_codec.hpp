#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "common/scene/scene.hpp"

namespace sightline {

/// Decodes a PNG or JPEG to 8-bit RGBA. Throws InputError beginning with `what` when it is neither, damaged,
/// or claims more than `most_pixels`, or more than 2^22 pixels and more than so many bytes can encode.
[[nodiscard]] Texture decode_image(std::span<const std::uint8_t> bytes, const std::string& what,
                                   std::uint64_t most_pixels = std::numeric_limits<std::uint64_t>::max());

/// The texture's pixels as a PNG, exactly.
[[nodiscard]] std::vector<std::uint8_t> encode_png(const Texture& texture);

}  // namespace sightline
