#include "tests/control_view/plain_raster.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "common/camera_path.hpp"
#include "common/gl/context.hpp"
#include "common/gl/item_buffer.hpp"
#include "common/scene/load_scene.hpp"
#include "tests/common/test_scenes.hpp"
#include "tests/control_view/raster_cases.hpp"

namespace sightline::test {
namespace {

std::vector<ObjectId> all_of(const Scene& scene) {
  std::vector<ObjectId> ids;
  for (std::uint32_t i = 0; i < scene.object_count(); ++i) ids.push_back(ObjectId{i});
  return ids;
}

struct Differences {
  std::size_t covered = 0;  ///< pixels with an object in either
  std::size_t codes = 0;
  std::size_t depths = 0;  ///< to the bit
};

Differences differences(const PlainImage& a, const PlainImage& b) {
  Differences found;
  for (std::size_t i = 0; i < a.codes.size(); ++i) {
    if (a.codes[i] != k_background_code || b.codes[i] != k_background_code) ++found.covered;
    if (a.codes[i] != b.codes[i]) ++found.codes;
    if (std::memcmp(&a.depth[i], &b.depth[i], sizeof(float)) != 0) ++found.depths;
  }
  return found;
}

/// OSMesa's pictures of one scene.
class Drawn {
 public:
  Drawn(const Scene& scene, ImageSize size) : scene_(scene, false), buffer_(size), ids_(all_of(scene)) {}

  PlainImage item_buffer(const Eye& eye) {
    PlainImage image{buffer_.size(), {}, std::vector<float>(buffer_.size().pixel_count())};
    buffer_.draw(scene_, eye, ids_);
    buffer_.read(image.codes);
    gl::glReadPixels(0, 0, static_cast<GLsizei>(image.size.width), static_cast<GLsizei>(image.size.height),
                     GL_DEPTH_COMPONENT, GL_FLOAT, image.depth.data());
    return image;
  }

  /// Pixels per object, opaque and blended.
  std::vector<std::uint32_t> counts(const Eye& eye) {
    std::vector<std::uint32_t> pixels(ids_.size(), 0);
    const PlainImage image = item_buffer(eye);
    for (const ItemCode code : image.codes) {
      if (code != k_background_code) ++pixels[index_of(object_of(code))];
    }
    std::vector<ObjectId> blended;
    std::copy_if(ids_.begin(), ids_.end(), std::back_inserter(blended),
                 [this](ObjectId id) { return scene_.has_layer(gl::Layer::blended, id); });
    std::vector<std::uint32_t> blended_pixels(blended.size(), 0);
    buffer_.count_blended(scene_, eye, blended, blended_pixels);
    for (std::size_t i = 0; i < blended.size(); ++i) pixels[index_of(blended[i])] += blended_pixels[i];
    return pixels;
  }

 private:
  gl::GpuScene scene_;
  gl::ItemBuffer buffer_;
  std::vector<ObjectId> ids_;
};

std::vector<std::uint32_t> dense(const PixelCounts& counts, std::uint32_t object_count) {
  std::vector<std::uint32_t> pixels(object_count, 0);
  for (std::size_t i = 0; i < counts.ids.size(); ++i) pixels[index_of(counts.ids[i])] = counts.pixels[i];
  return pixels;
}

bool fuses_multiply_add() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("fma") != 0;
#else
  return true;
#endif
}

class PlainRasterTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fuses_multiply_add()) GTEST_SKIP() << "llvmpipe rounds differently without fused multiply-add";
    const std::string driver = context_->description();
    if (driver.find("Mesa 22.3") == std::string::npos) GTEST_SKIP() << "made for Mesa 22.3, not " << driver;
  }

  std::unique_ptr<gl::Context> context_ = gl::make_offscreen_context(gl::ContextKind::osmesa);
};

TEST_F(PlainRasterTest, EqualsOsmesaToTheBitOnAdversarialCases) {
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    std::size_t covered = 0;
    for (const RasterCase& test : raster_cases(seed)) {
      const PlainImage plain = plain_item_buffer(test.scene, test.eye, all_of(test.scene), test.size);
      const Differences found = differences(plain, Drawn(test.scene, test.size).item_buffer(test.eye));
      EXPECT_EQ(found.codes, 0u) << test.name << ", seed " << seed << ", of " << found.covered << " pixels";
      EXPECT_EQ(found.depths, 0u) << test.name << ", seed " << seed << ", of " << found.covered << " pixels";
      if (test.size.pixel_count() > 1) {
        EXPECT_GT(found.covered, test.size.pixel_count() / 500) << test.name << ": too little to see";
      }
      covered += found.covered;
    }
    EXPECT_GT(covered, 100000u);
  }
}

TEST_F(PlainRasterTest, CountsBlendedObjectsAsOsmesaDoes) {
  std::size_t blended_objects = 0;
  for (const RasterCase& test : raster_cases(4)) {
    const Eye eyes[] = {test.eye};
    const auto counts = dense(plain_counts(test.scene, eyes, test.size), test.scene.object_count());
    EXPECT_EQ(counts, Drawn(test.scene, test.size).counts(test.eye)) << test.name;
    if (test.name.find("glass") != std::string::npos) {
      blended_objects += static_cast<std::size_t>(
          std::count_if(counts.begin(), counts.end(), [](std::uint32_t pixels) { return pixels > 0; }));
    }
  }
  EXPECT_GT(blended_objects, 10u);
}

TEST_F(PlainRasterTest, AddsUpSeveralEyes) {
  const std::vector<RasterCase> cases = raster_cases(5);
  const RasterCase& test = cases.front();
  const Eye both[] = {test.eye, test.eye};
  const auto once = plain_counts(test.scene, {both, 1}, test.size);
  auto twice = plain_counts(test.scene, both, test.size);
  for (std::uint32_t& pixels : twice.pixels) {
    EXPECT_EQ(pixels % 2, 0u);
    pixels /= 2;
  }
  EXPECT_EQ(once, twice);
  EXPECT_FALSE(once.ids.empty());
}

/// A scene of the shared folder at 512x384, at moments spread over its path.
class PlainRasterSceneTest : public PlainRasterTest, public ::testing::WithParamInterface<const char*> {};

TEST_P(PlainRasterSceneTest, EqualsOsmesaToTheBit) {
  const auto shared = testing::shared_folder();
  if (!shared) GTEST_SKIP() << "no ../shared folder with scenes";
  const auto folder = *shared / "scenes";
  const Scene scene = load_scene(folder / (std::string(GetParam()) + ".glb"), SceneLoadOptions{});
  const CameraPath path = read_camera_path(folder / (std::string(GetParam()) + ".path.csv"));
  constexpr ImageSize k_size{512, 384};
  Drawn drawn(scene, k_size);
  constexpr int k_views = 4;
  for (int i = 0; i < k_views; ++i) {
    const Pose pose = path.at(path.duration_s() * (i + 0.5) / k_views);
    const Eye eye{camera_from_world(pose), clip_from_camera(Perspective{}, 4.0 / 3.0)};
    const PlainImage plain = plain_item_buffer(scene, eye, all_of(scene), k_size);
    const Differences found = differences(plain, drawn.item_buffer(eye));
    EXPECT_EQ(found.codes, 0u) << "view " << i << ", of " << found.covered << " pixels";
    EXPECT_EQ(found.depths, 0u) << "view " << i << ", of " << found.covered << " pixels";
  }
}

INSTANTIATE_TEST_SUITE_P(Shared, PlainRasterSceneTest,
                         ::testing::Values("rotterdam", "denhaag01", "clinic", "walker_assembly"),
                         [](const auto& parameter) { return std::string(parameter.param); });

}  // namespace
}  // namespace sightline::test
