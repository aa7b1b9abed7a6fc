#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/scene/scene.hpp"

namespace sightline {

/// Decodes a PNG or JPEG to 8-bit RGBA. Throws InputError beginning with `what` when it is neither, damaged,
/// or claims more pixels than so many bytes can encode.
[[nodiscard]] Texture decode_image(std::span<const std::uint8_t> bytes, const std::string& what);

/// The texture's pixels as a PNG, exactly.
[[nodiscard]] std::vector<std::uint8_t> encode_png(const Texture& texture);

}  // namespace sightline
