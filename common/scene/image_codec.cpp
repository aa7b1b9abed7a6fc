#include "common/scene/image_codec.hpp"

#include <memory>
#include <new>

#include "common/scene/refuse_scene.hpp"

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 16384
#include <stb/stb_image.h>
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#include <stb/stb_image_write.h>

namespace sightline {
namespace {

/// Deflate gives at most 1032 bytes for one, and a byte of PNG holds at most eight pixels.
constexpr std::uint64_t k_most_pixels_a_byte = 1032 * 8;
/// What any image may have.
constexpr std::uint64_t k_unquestioned_pixels = 1u << 22;

}  // namespace

Texture decode_image(std::span<const std::uint8_t> bytes, const std::string& what,
                     std::uint64_t most_pixels) {
  int width = 0;
  int height = 0;
  int channels = 0;
  const auto size = static_cast<int>(std::min<std::size_t>(bytes.size(), 1u << 30));
  if (size == 0 || stbi_info_from_memory(bytes.data(), size, &width, &height, &channels) == 0 || width <= 0 ||
      height <= 0) {
    refuse_scene(what, "is not a PNG or JPEG image that can be decoded");
  }
  const std::uint64_t pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  if (pixels > k_unquestioned_pixels && pixels > bytes.size() * k_most_pixels_a_byte) {
    refuse_scene(what, "claims " + std::to_string(width) + " x " + std::to_string(height) + " pixels in " +
                           std::to_string(bytes.size()) + " bytes");
  }
  if (pixels > most_pixels) {
    refuse_scene(what, "its " + std::to_string(width) + " x " + std::to_string(height) +
                           " pixels bring the textures above 1 GiB; make them smaller");
  }
  const std::unique_ptr<stbi_uc, void (*)(void*)> decoded(
      stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, 4), &stbi_image_free);
  if (!decoded) refuse_scene(what, std::string("cannot be decoded: ") + stbi_failure_reason());
  Texture texture;
  texture.width = static_cast<std::uint32_t>(width);
  texture.height = static_cast<std::uint32_t>(height);
  texture.rgba.assign(decoded.get(), decoded.get() + 4 * pixels);
  return texture;
}

std::vector<std::uint8_t> encode_png(const Texture& texture) {
  std::vector<std::uint8_t> png;
  const auto append = [](void* target, void* data, int size) {
    auto& bytes = *static_cast<std::vector<std::uint8_t>*>(target);
    const auto* const first = static_cast<const std::uint8_t*>(data);
    bytes.insert(bytes.end(), first, first + size);
  };
  const auto width = static_cast<int>(texture.width);
  const auto height = static_cast<int>(texture.height);
  if (stbi_write_png_to_func(append, &png, width, height, 4, texture.rgba.data(), 4 * width) == 0) {
    throw std::bad_alloc();
  }
  return png;
}

}  // namespace sightline
