#include "main_view/app/image.hpp"

#include <algorithm>

namespace sightline {
namespace {

constexpr Rgb k_difference_color{255, 32, 32};

Rgb dimmed_gray(Rgb color) {
  const int luma = (54 * color.r + 183 * color.g + 19 * color.b) / 256;
  const auto gray = static_cast<std::uint8_t>(60 + luma / 4);
  return {gray, gray, gray};
}

}  // namespace

std::uint64_t differing_pixels(const Image& a, const Image& b) {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) count += a.pixels[i] == b.pixels[i] ? 0 : 1;
  return count;
}

Image difference_image(const Image& a, const Image& b) {
  Image result(a.size);
  std::transform(a.pixels.begin(), a.pixels.end(), result.pixels.begin(), dimmed_gray);
  for (std::uint32_t y = 0; y < a.size.height; ++y) {
    for (std::uint32_t x = 0; x < a.size.width; ++x) {
      if (a.at(x, y) == b.at(x, y)) continue;
      const std::uint32_t right = std::min(x + 1, a.size.width - 1);
      const std::uint32_t bottom = std::min(y + 1, a.size.height - 1);
      for (std::uint32_t ny = y == 0 ? 0 : y - 1; ny <= bottom; ++ny) {
        for (std::uint32_t nx = x == 0 ? 0 : x - 1; nx <= right; ++nx) result.at(nx, ny) = k_difference_color;
      }
    }
  }
  return result;
}

}  // namespace sightline
