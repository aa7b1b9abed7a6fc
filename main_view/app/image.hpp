#pragma once

#include <cstdint>
#include <vector>

#include "common/view.hpp"

namespace sightline {

/// 8-bit sRGB colour.
struct Rgb {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  bool operator==(const Rgb&) const = default;
};

/// Picture of 8-bit sRGB pixels, rows from the top.
struct Image {
  ImageSize size;
  std::vector<Rgb> pixels;  ///< size.pixel_count() of them

  Image() = default;
  explicit Image(ImageSize image_size, Rgb fill = {})
      : size(image_size), pixels(image_size.pixel_count(), fill) {}
  bool operator==(const Image&) const = default;
  [[nodiscard]] Rgb& at(std::uint32_t x, std::uint32_t y) noexcept {
    return pixels[std::size_t{y} * size.width + x];
  }
  [[nodiscard]] const Rgb& at(std::uint32_t x, std::uint32_t y) const noexcept {
    return pixels[std::size_t{y} * size.width + x];
  }
};

/// Pixels whose colour differs. Requires equal sizes.
[[nodiscard]] std::uint64_t differing_pixels(const Image& a, const Image& b);

/// Equal pixels as a dimmed grey of `a`, differing ones bright red and swollen by a pixel, so that a single
/// one can be found. Requires equal sizes.
[[nodiscard]] Image difference_image(const Image& a, const Image& b);

}  // namespace sightline
