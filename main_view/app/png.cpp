#include "main_view/app/png.hpp"

#include <fstream>
#include <new>
#include <system_error>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#endif
#include <stb/stb_image_write.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#include "common/error.hpp"

namespace sightline {

static_assert(sizeof(Rgb) == 3, "an Image's rows are handed to the encoder as they lie");

void write_png(const std::filesystem::path& file, const Image& image) {
  std::vector<char> bytes;
  const auto append = [](void* context, void* data, int size) {
    auto& out = *static_cast<std::vector<char>*>(context);
    const auto* begin = static_cast<const char*>(data);
    out.insert(out.end(), begin, begin + size);
  };
  const int width = static_cast<int>(image.size.width);
  const int height = static_cast<int>(image.size.height);
  if (stbi_write_png_to_func(append, &bytes, width, height, 3, image.pixels.data(), 3 * width) == 0) {
    throw InputError(file.string() + ": an image of " + std::to_string(width) + "x" + std::to_string(height) +
                     " pixels cannot be encoded as PNG");
  }
  std::ofstream stream(file, std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream) {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(file, ignored)) std::filesystem::remove(file, ignored);
    throw InputError(file.string() +
                     ": cannot be written; name a file in a folder that exists and is writable");
  }
}

}  // namespace sightline
