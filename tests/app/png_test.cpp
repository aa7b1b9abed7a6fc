#include "main_view/app/png.hpp"

#include <memory>
#include <random>

#include <gtest/gtest.h>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

#include "common/error.hpp"
#include "tests/common/test_scenes.hpp"

namespace sightline {
namespace {

Image noise(ImageSize size) {
  std::mt19937 random(7);
  Image image(size);
  for (Rgb& pixel : image.pixels) {
    const auto bits = random();
    pixel = {std::uint8_t(bits), std::uint8_t(bits >> 8), std::uint8_t(bits >> 16)};
  }
  return image;
}

TEST(Png, GivesBackEveryPixelFromTheTop) {
  const testing::TemporaryFolder folder;
  const Image image = noise({37, 19});
  write_png(folder / "noise.png", image);
  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<unsigned char, void (*)(void*)> bytes(
      stbi_load((folder / "noise.png").c_str(), &width, &height, &channels, 3), stbi_image_free);
  ASSERT_NE(bytes, nullptr);
  ASSERT_EQ(width, 37);
  ASSERT_EQ(height, 19);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    ASSERT_EQ(image.pixels[i], (Rgb{bytes.get()[3 * i], bytes.get()[3 * i + 1], bytes.get()[3 * i + 2]}))
        << i;
  }
}

TEST(Png, NamesTheFileItCannotWrite) {
  const testing::TemporaryFolder folder;
  const auto file = folder.path() / "no such folder" / "image.png";
  try {
    write_png(file, noise({4, 4}));
    FAIL() << "wrote into a folder that does not exist";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(file.string()), std::string::npos);
  }
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(Image, CountsDifferingPixelsAndMarksThem) {
  const Image a = noise({16, 16});
  Image b = a;
  EXPECT_EQ(differing_pixels(a, b), 0u);
  b.at(5, 9).g ^= 1;
  b.at(0, 0).r ^= 128;
  EXPECT_EQ(differing_pixels(a, b), 2u);
  const Image difference = difference_image(a, b);
  EXPECT_EQ(difference.at(5, 9), (Rgb{255, 32, 32}));
  EXPECT_EQ(difference.at(0, 0), (Rgb{255, 32, 32}));
  EXPECT_EQ(difference.at(12, 3).r, difference.at(12, 3).b) << "an equal pixel is grey";
}

}  // namespace
}  // namespace sightline
