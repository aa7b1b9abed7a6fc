#include "common/gl/item_buffer.hpp"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "common/gl/context.hpp"
#include "tests/gl/random_scene.hpp"

namespace sightline {
namespace {

using namespace testing;  // the scene builders

constexpr ImageSize k_size{160, 120};

std::vector<ObjectId> all_of(const Scene& scene) {
  std::vector<ObjectId> ids;
  for (std::uint32_t i = 0; i < scene.object_count(); ++i) ids.push_back(ObjectId{i});
  return ids;
}

class ItemBufferTest : public ::testing::Test {
 protected:
  /// Codes of `ids` alone, or of the whole scene.
  std::vector<ItemCode> drawn(const Scene& scene, const Eye& eye,
                              std::optional<std::vector<ObjectId>> ids = {}) {
    gl::GpuScene gpu_scene(scene, false);
    gl::ItemBuffer buffer(k_size);
    buffer.draw(gpu_scene, eye, ids ? *ids : all_of(scene));
    std::vector<ItemCode> codes;
    buffer.read(codes);
    return codes;
  }

  static std::size_t pixels_of(const std::vector<ItemCode>& codes, ObjectId id) {
    return static_cast<std::size_t>(std::count(codes.begin(), codes.end(), code_of(id)));
  }

  std::unique_ptr<gl::Context> context_ = gl::make_offscreen_context(gl::ContextKind::osmesa);
  Eye eye_ = eye_at({0, 0, 0}, 0.0, 0.0, k_size);
};

TEST_F(ItemBufferTest, ShowsTheNearerOfTwoWalls) {
  SceneBuilder builder;
  const auto stone = builder.add_material(opaque());
  const ObjectId far = builder.add_wall({0, 0, -20}, 100, 100, stone);
  const ObjectId near = builder.add_wall({0, 0, -10}, 4, 4, stone);
  const auto codes = drawn(builder.finish(), eye_);
  // 4 m at 10 m under 60 degrees of 120 pixels: 4 / (20 tan 30) * 120 = 41.6 pixels a side.
  EXPECT_NEAR(double(pixels_of(codes, near)), 41.6 * 41.6, 90.0);
  EXPECT_EQ(pixels_of(codes, far) + pixels_of(codes, near), k_size.pixel_count());
}

TEST_F(ItemBufferTest, RowsRunFromTheBottom) {
  SceneBuilder builder;
  const auto stone = builder.add_material(opaque());
  const ObjectId low = builder.add_wall({0, -5, -10}, 100, 10, stone);
  const auto codes = drawn(builder.finish(), eye_);
  EXPECT_EQ(codes.front(), code_of(low));
  EXPECT_EQ(codes.back(), k_background_code);
}

TEST_F(ItemBufferTest, CullsBackFacesUnlessDoubleSided) {
  SceneBuilder builder;
  const auto stone = builder.add_material(opaque());
  const auto card = builder.add_material(double_sided());
  const ObjectId one_sided = builder.add_wall({-3, 0, -10}, 4, 4, stone, 3.14159265358979);
  const ObjectId two_sided = builder.add_wall({3, 0, -10}, 4, 4, card, 3.14159265358979);
  const auto codes = drawn(builder.finish(), eye_);
  EXPECT_EQ(pixels_of(codes, one_sided), 0u);
  EXPECT_GT(pixels_of(codes, two_sided), 1000u);
}

TEST_F(ItemBufferTest, AMirroredBoxLooksLikeTheBox) {
  SceneBuilder plain, mirrored;
  plain.add_box({1, 0, -8}, {2, 3, 1}, plain.add_material(opaque()));
  mirrored.add_box({1, 0, -8}, {-2, 3, 1}, mirrored.add_material(opaque()));
  const auto expected = drawn(plain.finish(), eye_);
  EXPECT_EQ(drawn(mirrored.finish(), eye_), expected);
  EXPECT_GT(pixels_of(expected, ObjectId{0}), 500u);
}

TEST_F(ItemBufferTest, ACutOutFenceShowsWhatIsBehindItsHoles) {
  SceneBuilder builder;
  const auto stone = builder.add_material(opaque());
  const auto mask = builder.add_checker_mask(8);
  const ObjectId behind = builder.add_wall({0, 0, -20}, 100, 100, stone);
  const ObjectId fence = builder.add_wall({0, 0, -10}, 8, 8, mask);
  const auto codes = drawn(builder.finish(), eye_);
  const auto fence_area = static_cast<double>(83 * 83);  // twice the 41.6 of a 4 m side
  EXPECT_NEAR(double(pixels_of(codes, fence)), fence_area / 2, fence_area / 20);
  EXPECT_EQ(pixels_of(codes, behind) + pixels_of(codes, fence), k_size.pixel_count());
}

TEST_F(ItemBufferTest, GivesTheSamePictureTwoThousandKilometresOut) {
  const Scene here = random_scene(3, 60);
  Scene there = here;
  const glm::dvec3 offset(2.0e6, 0.0, -1.5e6);
  there.world_origin_m = offset;
  Eye far_eye = eye_at({0, 0, 0}, 0.4, 0.1, k_size);
  const auto expected = drawn(here, far_eye);
  far_eye = eye_at(offset, 0.4, 0.1, k_size);
  const auto codes = drawn(there, far_eye);
  // The eye's position is exact in double; rounding of the product may move a silhouette by a pixel here and
  // there.
  std::size_t differing = 0;
  for (std::size_t i = 0; i < codes.size(); ++i) differing += codes[i] != expected[i];
  EXPECT_LE(differing, codes.size() / 2000);
  EXPECT_GT(codes.size() - pixels_of(codes, ObjectId{0xfffffffe}), 0u);
}

TEST_F(ItemBufferTest, LeavingHiddenObjectsOutChangesNoPixel) {
  std::mt19937 random(11);
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    const Scene scene = random_scene(seed, 120);
    const Eye eye = random_eye(random, k_size);
    const auto whole = drawn(scene, eye);
    std::vector<ObjectId> visible;
    for (const ObjectId id : all_of(scene)) {
      if (pixels_of(whole, id) > 0) visible.push_back(id);
    }
    EXPECT_LT(visible.size(), scene.object_count() / 2) << "the view hides too little to test anything";
    EXPECT_EQ(drawn(scene, eye, visible), whole) << "seed " << seed;
  }
}

TEST_F(ItemBufferTest, ARectangleEqualsThatPartOfTheWhole) {
  const Scene scene = random_scene(5, 100);
  const Eye eye = eye_at({0, 0, 14}, 0.0, 0.0, k_size);
  const auto whole = drawn(scene, eye);
  gl::GpuScene gpu_scene(scene, false);
  gl::ItemBuffer buffer(k_size);
  const gl::PixelRect rect{50, 30, {64, 48}};
  buffer.draw(gpu_scene, eye, all_of(scene), rect);
  std::vector<ItemCode> part;
  buffer.read(part, rect);
  ASSERT_EQ(part.size(), rect.size.pixel_count());
  for (std::uint32_t y = 0; y < rect.size.height; ++y) {
    for (std::uint32_t x = 0; x < rect.size.width; ++x) {
      ASSERT_EQ(part[y * rect.size.width + x], whole[(y + rect.y) * k_size.width + x + rect.x]);
    }
  }
}

TEST_F(ItemBufferTest, CountsEachBlendedObjectAgainstTheOpaqueDepthAlone) {
  SceneBuilder builder;
  const auto stone = builder.add_material(opaque());
  const auto pane = builder.add_material(glass());
  const ObjectId front = builder.add_wall({0, 0, -5}, 1, 1, pane);
  const ObjectId middle = builder.add_wall({0, 0, -6}, 1, 1, pane);
  builder.add_wall({0, 0, -10}, 100, 100, stone);
  const ObjectId behind = builder.add_wall({0, 0, -15}, 1, 1, pane);
  const Scene scene = builder.finish();
  gl::GpuScene gpu_scene(scene, false);
  gl::ItemBuffer buffer(k_size);
  buffer.draw(gpu_scene, eye_, all_of(scene));
  const std::vector<ObjectId> blended = {front, middle, behind};
  std::vector<std::uint32_t> pixels(3, 0);
  buffer.count_blended(gpu_scene, eye_, blended, pixels);
  EXPECT_GT(pixels[0], 300u);
  EXPECT_GT(pixels[1], 200u);  // glass hides no glass
  EXPECT_EQ(pixels[2], 0u);
}

TEST_F(ItemBufferTest, CountsAPixelOnceHoweverManyFacesOfABlendedObjectCoverIt) {
  SceneBuilder box, wall;
  box.add_box({0, 0, -5.5}, {1, 1, 1}, box.add_material(double_sided(glass())));
  wall.add_wall({0, 0, -5}, 1, 1, wall.add_material(glass()));
  std::vector<std::uint32_t> in_box(1, 0), in_wall(1, 0);
  const std::vector<ObjectId> only = {ObjectId{0}};
  for (auto [builder, pixels] : {std::pair{&box, &in_box}, std::pair{&wall, &in_wall}}) {
    gl::GpuScene gpu_scene(builder->finish(), false);
    gl::ItemBuffer buffer(k_size);
    buffer.draw(gpu_scene, eye_, only);
    buffer.count_blended(gpu_scene, eye_, only, *pixels);
  }
  EXPECT_EQ(in_box, in_wall);  // head on, the box shows just its front face's outline
  EXPECT_GT(in_wall[0], 0u);
}

TEST_F(ItemBufferTest, CountsMoreBlendedObjectsThanTheStencilHasMarks) {
  SceneBuilder builder;
  const auto pane = builder.add_material(glass());
  std::vector<ObjectId> ids;
  for (int i = 0; i < 600; ++i) ids.push_back(builder.add_wall({0, 0, -5.0 - 0.001 * i}, 1, 1, pane));
  const Scene scene = builder.finish();
  gl::GpuScene gpu_scene(scene, false);
  gl::ItemBuffer buffer(k_size);
  buffer.draw(gpu_scene, eye_, ids);
  std::vector<std::uint32_t> pixels(ids.size(), 0);
  buffer.count_blended(gpu_scene, eye_, ids, pixels);
  EXPECT_EQ(std::count(pixels.begin(), pixels.end(), 0u), 0);
}

TEST_F(ItemBufferTest, TellsMoreObjectsApartThanSixteenBitsCould) {
  SceneBuilder builder;
  const auto stone = builder.add_material(opaque());
  const auto mesh = builder.quad_mesh(stone);
  constexpr std::uint32_t k_many = 70'000;
  for (std::uint32_t i = 0; i + 1 < k_many; ++i) {
    builder.add_object(mesh,
                       glm::dmat4(glm::dvec4(1, 0, 0, 0), glm::dvec4(0, 1, 0, 0), glm::dvec4(0, 0, 1, 0),
                                  glm::dvec4(1000.0, 0, 50.0, 1)));  // out of sight
  }
  const ObjectId last = builder.add_wall({0, 0, -5}, 2, 2, stone);
  ASSERT_EQ(index_of(last), k_many - 1);
  EXPECT_GT(pixels_of(drawn(builder.finish(), eye_), last), 1000u);
}

TEST_F(ItemBufferTest, ABoxThatTheNearPlaneCutsIsStillSeen) {
  SceneBuilder builder;
  const ObjectId around = builder.add_box({0, 0, 0}, {4, 4, 4}, builder.add_material(double_sided()));
  EXPECT_EQ(pixels_of(drawn(builder.finish(), eye_), around), k_size.pixel_count());
}

}  // namespace
}  // namespace sightline
