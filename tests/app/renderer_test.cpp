#include "main_view/app/renderer.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <random>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "common/gl/context.hpp"
#include "common/gl/item_buffer.hpp"
#include "main_view/app/drawable_scene.hpp"
#include "tests/common/test_scenes.hpp"

namespace sightline {
namespace {

using testing::SceneBuilder;

constexpr ImageSize k_size{160, 120};

Eye eye_at(const glm::dvec3& from, const glm::dvec3& to) {
  return {glm::lookAt(from, to, glm::dvec3(0, 1, 0)),
          clip_from_camera({.near_m = 0.1, .far_m = 1000.0}, double(k_size.width) / k_size.height)};
}

class Renderer : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { context_ = gl::make_offscreen_context(gl::ContextKind::osmesa); }
  static void TearDownTestSuite() { context_.reset(); }

  /// Exactly the objects that an item buffer of the image's size shows, blended ones included.
  static std::vector<ObjectId> visible(DrawableScene& scene, const Eye& eye) {
    gl::ItemBuffer items(k_size);
    items.draw(scene.gpu(), eye, scene.all_ids());
    std::vector<ItemCode> codes;
    items.read(codes);
    std::vector<ObjectId> blended;
    for (const ObjectId id : scene.all_ids()) {
      if (scene.gpu().has_layer(gl::Layer::blended, id)) blended.push_back(id);
    }
    std::vector<std::uint32_t> pixels(blended.size());
    items.count_blended(scene.gpu(), eye, blended, pixels);
    std::vector<ObjectId> ids;
    for (const ItemCode code : codes) {
      if (code != k_background_code) ids.push_back(object_of(code));
    }
    for (std::size_t i = 0; i < blended.size(); ++i) {
      if (pixels[i] > 0) ids.push_back(blended[i]);
    }
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    return ids;
  }

  static Image picture(DrawableScene& scene, const Eye& eye, std::span<const ObjectId> ids) {
    const RenderTarget target(k_size);
    scene.renderer().draw(target, eye, ids);
    return target.read();
  }

  /// The visible objects alone give the whole picture; fewer objects than there are; and without the nearest
  /// of them the picture changes, so that the comparison cannot pass by drawing nothing.
  static void expect_same_picture(Scene built, const Eye& eye) {
    DrawableScene scene(std::move(built));
    const auto ids = visible(scene, eye);
    ASSERT_FALSE(ids.empty());
    EXPECT_LT(ids.size(), scene.all_ids().size()) << "nothing was hidden";
    const Image whole = picture(scene, eye, scene.all_ids());
    EXPECT_EQ(differing_pixels(picture(scene, eye, ids), whole), 0u);
    std::uint64_t changed = 0;
    for (std::size_t left_out = 0; left_out < ids.size(); ++left_out) {
      auto fewer = ids;
      fewer.erase(fewer.begin() + std::ptrdiff_t(left_out));
      changed += differing_pixels(picture(scene, eye, fewer), whole) > 0;
    }
    EXPECT_GT(changed, 0u);
  }

  /// Boxes strewn before the camera, behind one another; some mirrored.
  static void add_crowd(SceneBuilder& builder, std::uint32_t material, const glm::dvec3& origin,
                        unsigned seed, bool mirrored = false) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> across(-6.0, 6.0), away(-40.0, -5.0), size(0.5, 4.0);
    for (int i = 0; i < 60; ++i) {
      const double flip = mirrored && i % 2 == 0 ? -1.0 : 1.0;
      builder.add_box(origin + glm::dvec3(across(random), across(random), away(random)),
                      {flip * size(random), size(random), size(random)}, material);
    }
  }

 private:
  static std::unique_ptr<gl::Context> context_;
};

std::unique_ptr<gl::Context> Renderer::context_;

TEST_F(Renderer, OpaqueObjects) {
  SceneBuilder builder;
  add_crowd(builder, builder.add_material(testing::opaque()), {}, 1);
  expect_same_picture(builder.finish(), eye_at({0, 0, 0}, {0, 0, -1}));
}

TEST_F(Renderer, BlendedObjectsBehindAndBeforeOpaqueOnes) {
  SceneBuilder builder;
  add_crowd(builder, builder.add_material(testing::opaque({0.7f, 0.3f, 0.2f})), {}, 2);
  add_crowd(builder, builder.add_material(testing::glass(0.4f)), {}, 3);
  expect_same_picture(builder.finish(), eye_at({0, 0, 0}, {0, 0, -1}));
}

TEST_F(Renderer, MaskedObjectsShowWhatIsBehindTheirHoles) {
  SceneBuilder builder;
  const auto leaves = builder.add_checker_mask(6);
  builder.add_wall({0, 0, -4}, 4.0, 3.0, leaves);
  add_crowd(builder, builder.add_material(testing::opaque({0.2f, 0.6f, 0.3f})), {}, 4);
  expect_same_picture(builder.finish(), eye_at({0, 0, 0}, {0, 0, -1}));
}

TEST_F(Renderer, DoubleSidedWallsSeenFromBothSides) {
  SceneBuilder builder;
  const auto paper = builder.add_material(testing::double_sided());
  for (int i = 0; i < 12; ++i)
    builder.add_wall({i % 4 - 1.5, 0, -4.0 - i}, 1.4, 2.0, paper, i % 2 == 0 ? 3.0 : 0.1);
  add_crowd(builder, builder.add_material(testing::opaque()), {0, 0, -20}, 5);
  expect_same_picture(builder.finish(), eye_at({0, 0, 0}, {0, 0, -1}));
}

TEST_F(Renderer, MirroredObjects) {
  SceneBuilder builder;
  add_crowd(builder, builder.add_material(testing::opaque()), {}, 6, true);
  expect_same_picture(builder.finish(), eye_at({0, 0, 0}, {0, 0, -1}));
}

TEST_F(Renderer, CoincidentSurfaces) {
  SceneBuilder builder;
  const auto red = builder.add_material(testing::opaque({0.9f, 0.1f, 0.1f}));
  const auto blue = builder.add_material(testing::opaque({0.1f, 0.1f, 0.9f}));
  // Each of the pairs lies in the other's very planes; the first of each wins whole or in part.
  for (int i = 0; i < 6; ++i) {
    const glm::dvec3 center(i - 2.5, 0.2 * i, -6.0 - i);
    builder.add_box(center, {1.5, 1.5, 1.5}, i % 2 == 0 ? red : blue);
    builder.add_box(center, {1.5, 1.5, 1.5}, i % 2 == 0 ? blue : red);
    builder.add_box(center + glm::dvec3(0.3, 0, 0), {1.5, 1.5, 1.5}, red);
  }
  expect_same_picture(builder.finish(), eye_at({0.3, 0.4, 0}, {0, 0, -6}));
}

TEST_F(Renderer, TwoThousandKilometresFromTheOrigin) {
  const glm::dvec3 far_away(2.0e6, 100.0, -1.0e6);
  SceneBuilder builder;
  add_crowd(builder, builder.add_material(testing::opaque()), {}, 7);
  Scene scene = builder.finish();
  const Eye near_eye = eye_at({0, 0, 0}, {0, 0, -1});
  DrawableScene here(scene);
  const Image picture_here = picture(here, near_eye, here.all_ids());
  scene.world_origin_m = far_away;
  const Eye far_eye = eye_at(far_away, far_away + glm::dvec3(0, 0, -1));
  DrawableScene there(scene);
  EXPECT_LT(differing_pixels(picture(there, far_eye, there.all_ids()), picture_here), 20u)
      << "far from the origin the scene looks as it does at the origin";
  expect_same_picture(std::move(scene), far_eye);
}

TEST_F(Renderer, FileWithoutNormalsGetsFlatOnes) {
  SceneBuilder builder;
  const auto stone = builder.add_material(testing::opaque());
  builder.add_box({0, 0, -4}, {2, 2, 2}, stone);
  Scene scene = builder.finish();
  const Eye eye = eye_at({1.5, 1.5, 0}, {0, 0, -4});
  DrawableScene with(scene);
  const Image with_normals = picture(with, eye, with.all_ids());
  scene.normals.clear();
  DrawableScene without(std::move(scene));
  const Image flat = picture(without, eye, without.all_ids());
  // A box's faces are flat already, so only rounding may differ.
  std::size_t far_off = 0;
  for (std::size_t i = 0; i < flat.pixels.size(); ++i) {
    far_off += std::abs(flat.pixels[i].r - with_normals.pixels[i].r) > 6;
  }
  EXPECT_LT(far_off, flat.pixels.size() / 200);
}

TEST_F(Renderer, CountsWhatItDraws) {
  SceneBuilder builder;
  builder.add_box({0, 0, -4}, {1, 1, 1}, builder.add_material(testing::opaque()));
  builder.add_box({2, 0, -4}, {1, 1, 1}, builder.add_material(testing::glass()));
  DrawableScene scene(builder.finish());
  const RenderTarget target(k_size);
  const auto stats = scene.renderer().draw(target, eye_at({0, 0, 0}, {0, 0, -1}), scene.all_ids());
  EXPECT_EQ(stats.objects, 2u);
  EXPECT_EQ(stats.triangles, 24u);
  EXPECT_EQ(scene.renderer().draw(target, eye_at({0, 0, 0}, {0, 0, -1}), {}).objects, 0u);
}

}  // namespace
}  // namespace sightline
