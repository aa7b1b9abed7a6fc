#include "main_view/app/item_colors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace sightline {
namespace {

constexpr Rgb k_background{16, 18, 24};

std::uint8_t channel(double hue, double saturation, double value, int sector) {
  // HSV to RGB, one channel: sector 5, 3, 1 for red, green, blue.
  const double at = std::fmod(sector + hue * 6.0, 6.0);
  const double share = std::max(0.0, std::min({at, 4.0 - at, 1.0}));
  return static_cast<std::uint8_t>(std::lround(255.0 * value * (1.0 - saturation * share)));
}

}  // namespace

Rgb item_color(ItemCode code) {
  if (code == k_background_code) return k_background;
  // Steps of the golden ratio spread successive hues as evenly as any fixed step can.
  const double hue = std::fmod(code * 0.6180339887498949, 1.0);
  const std::uint32_t mixed = (code ^ (code >> 15)) * 0x2c1b3c6du;
  const double saturation = 0.45 + 0.40 * ((mixed >> 8) & 0xff) / 255.0;
  const double value = 0.60 + 0.38 * ((mixed >> 20) & 0xff) / 255.0;
  return {channel(hue, saturation, value, 5), channel(hue, saturation, value, 3),
          channel(hue, saturation, value, 1)};
}

Image item_image(std::span<const ItemCode> codes, ImageSize size) {
  Image image(size);
  for (std::uint32_t y = 0; y < size.height; ++y) {
    const ItemCode* row = codes.data() + std::size_t{size.height - 1 - y} * size.width;
    for (std::uint32_t x = 0; x < size.width; ++x) image.at(x, y) = item_color(row[x]);
  }
  return image;
}

}  // namespace sightline
