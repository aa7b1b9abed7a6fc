#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "protocol/scene_chunks.hpp"
#include "tests/client/client_scenes.hpp"

namespace sightline {
namespace {

using testing::add_cube;
using testing::placed_at;

const std::vector<glm::vec3> k_corners{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {9, 9, 9}};
const std::vector<std::uint32_t> k_triangle{0, 1, 2};

TEST(SceneDescription, PacksWhatWasAddedWithItsDigest) {
  SceneDescription scene;
  const std::vector<std::uint8_t> texels{0, 255, 255, 0};
  const AlphaTextureId texture = scene.add_alpha_texture({2, 2, texels, false, true});
  MaterialDescription leaves;
  leaves.alpha_mode = SceneData::AlphaMode::mask;
  leaves.alpha_texture = texture;
  const MaterialId material = scene.add_material(leaves);
  const MeshId plain = scene.add_mesh(k_corners, k_triangle);
  const std::vector<glm::vec2> uvs(4, glm::vec2(0.25f, 0.75f));
  const std::vector<std::uint32_t> two{0, 1, 2, 2, 1, 0};
  const std::vector<MeshPart> parts{{0, 3, MaterialId{}}, {3, 3, material}};
  const MeshId leafy = scene.add_mesh(k_corners, two, parts, uvs);
  EXPECT_EQ(scene.add_object(plain, placed_at({1, 2, 3})), ObjectId{0});
  EXPECT_EQ(scene.add_object(leafy, placed_at({4, 5, 6}), 5, 9), ObjectId{1});
  EXPECT_EQ(scene.add_object(leafy, placed_at({7, 8, 9})), ObjectId{2});
  scene.set_spare_objects(4);
  EXPECT_EQ(scene.object_count(), 3u);
  EXPECT_EQ(scene.triangle_count(), 5u);

  const auto packed = scene.pack();
  EXPECT_EQ(scene.object_count(), 0u);
  EXPECT_EQ(packed->offer.object_count, 7u);
  EXPECT_EQ(packed->offer.triangle_count, 5u);
  EXPECT_EQ(packed->offer.scene_digest, scene_digest_of(packed->offer));
  EXPECT_EQ(packed->objects.digest, packed->offer.scene_digest);
  EXPECT_EQ(packed->objects.object_count(), 7u);
  const Aabb of_the_triangle{{0, 0, 0}, {1, 2, 0}};  // not of the vertex that nothing uses
  EXPECT_EQ(packed->objects.objects[0].object_bounds, of_the_triangle);
  EXPECT_EQ(packed->objects.objects[1].group, 9u);

  auto decoded = decode_scene_data(packed->bytes);
  ASSERT_TRUE(std::holds_alternative<SceneData>(decoded));
  const SceneData& data = std::get<SceneData>(decoded);
  EXPECT_EQ(data.triangle_count(), 5u);
  ASSERT_EQ(data.uvs.size(), 8u);  // of the mesh before, too
  EXPECT_EQ(data.uvs[0], glm::vec2(0.0f));
  EXPECT_EQ(data.uvs[4], glm::vec2(0.25f, 0.75f));
  EXPECT_EQ(data.indices[3], 4u);
  ASSERT_EQ(data.primitives.size(), 3u);
  EXPECT_EQ(data.primitives[2].first_index, 6u);
  EXPECT_EQ(data.primitives[2].material, 1u);
  EXPECT_EQ(data.objects[1].flags, 5u);
  EXPECT_EQ(data.objects[2].world_from_object, placed_at({7, 8, 9}));
  EXPECT_EQ(data.spare_objects, 4u);
}

TEST(SceneDescription, GivesTheSameDigestForTheSameScene) {
  const auto pack = [](double x_m) {
    SceneDescription scene;
    scene.add_object(add_cube(scene), placed_at({x_m, 0, 0}));
    return scene.pack()->offer.scene_digest;
  };
  EXPECT_EQ(pack(1.0), pack(1.0));
  EXPECT_NE(pack(1.0), pack(1.5));
}

TEST(SceneDescription, RefusesWhatBreaksARuleAndIsAsItWas) {
  SceneDescription scene;
  const MeshId mesh = scene.add_mesh(k_corners, k_triangle);
  scene.add_object(mesh, placed_at({0, 0, 0}));
  const auto packed_before = [&] {
    SceneDescription copy = scene;
    return copy.pack()->offer.scene_digest;
  };
  const SceneDigest before = packed_before();

  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<glm::vec3> broken{{0, 0, 0}, {1, nan, 0}, {0, 2, 0}};
  const std::vector<std::uint32_t> too_far{0, 1, 4}, half{0, 1};
  const std::vector<glm::vec2> few_uvs(2), broken_uvs(4, glm::vec2(nan));
  const std::vector<MeshPart> beyond{{0, 6, {}}}, overflowing{{0xfffffffeu, 3, {}}}, not_whole{{0, 2, {}}};
  EXPECT_THROW(scene.add_mesh(broken, k_triangle), InputError);
  EXPECT_THROW(scene.add_mesh(k_corners, too_far), InputError);
  EXPECT_THROW(scene.add_mesh(k_corners, half), InputError);
  EXPECT_THROW(scene.add_mesh(k_corners, k_triangle, MaterialId{7}), InputError);
  EXPECT_THROW(scene.add_mesh(k_corners, k_triangle, MaterialId{}, few_uvs), InputError);
  EXPECT_THROW(scene.add_mesh(k_corners, k_triangle, MaterialId{}, broken_uvs), InputError);
  EXPECT_THROW(scene.add_mesh(k_corners, k_triangle, beyond), InputError);
  EXPECT_THROW(scene.add_mesh(k_corners, k_triangle, overflowing), InputError);
  EXPECT_THROW(scene.add_mesh(k_corners, k_triangle, not_whole), InputError);
  EXPECT_THROW(scene.add_mesh({}, k_triangle), InputError);
  EXPECT_THROW(scene.add_object(MeshId{1}, placed_at({0, 0, 0})), InputError);
  EXPECT_THROW(scene.add_object(mesh, placed_at({0, std::nan(""), 0})), InputError);
  EXPECT_THROW(scene.add_object(mesh, placed_at({1e13, 0, 0})), InputError);
  EXPECT_THROW(scene.add_object(mesh, placed_at({0, 0, 0}), 16), InputError);
  MaterialDescription material;
  material.base_alpha = nan;
  EXPECT_THROW(scene.add_material(material), InputError);
  material = {};
  material.alpha_texture = AlphaTextureId{0};
  EXPECT_THROW(scene.add_material(material), InputError);
  const std::vector<std::uint8_t> texels(3);
  EXPECT_THROW(scene.add_alpha_texture({2, 2, texels}), InputError);
  EXPECT_THROW(scene.add_alpha_texture({0, 2, {}}), InputError);
  EXPECT_THROW(scene.add_alpha_texture({0xffffffffu, 0xffffffffu, texels}), InputError);
  EXPECT_THROW(scene.set_spare_objects(0xffffffffu), InputError);
  EXPECT_EQ(packed_before(), before);
  EXPECT_THROW((void)SceneDescription().pack(), InputError);
}

}  // namespace
}  // namespace sightline
