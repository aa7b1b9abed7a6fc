#include "protocol/scene_data.hpp"

#include <cstring>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "protocol/scene_chunks.hpp"
#include "sample_messages.hpp"

namespace sightline {
namespace {

using testing::HasSubstr;

SceneData random_scene(std::mt19937_64& random) {
  SceneData scene;
  const auto some = [&](std::uint64_t most) { return random() % (most + 1); };
  const auto number = [&] { return static_cast<float>(static_cast<double>(random() % 2000) - 1000.0); };
  for (std::uint64_t left = some(40); left > 0; --left)
    scene.positions.emplace_back(number(), number(), number());
  if (random() % 2 == 0) scene.uvs.resize(scene.positions.size(), {number(), number()});
  for (std::uint64_t left = some(60); left > 0; --left)
    scene.indices.push_back(static_cast<std::uint32_t>(random()));
  for (std::uint64_t left = some(5); left > 0; --left)
    scene.primitives.push_back({static_cast<std::uint32_t>(some(9)), static_cast<std::uint32_t>(some(9)), 1});
  for (std::uint64_t left = some(5); left > 0; --left)
    scene.meshes.push_back({static_cast<std::uint32_t>(some(9)), static_cast<std::uint32_t>(some(9))});
  for (std::uint64_t left = some(3); left > 0; --left) {
    scene.materials.push_back({number(), number(), static_cast<std::uint32_t>(random()),
                               static_cast<SceneData::AlphaMode>(random() % 3), random() % 2 == 0});
  }
  for (std::uint64_t left = some(2); left > 0; --left) {
    SceneData::AlphaTexture texture{3, 2, random() % 2 == 0, random() % 2 == 0, {}};
    for (int i = 0; i < 6; ++i) texture.alpha.push_back(static_cast<std::uint8_t>(random()));
    scene.alpha_textures.push_back(texture);
  }
  for (std::uint64_t left = some(6); left > 0; --left) {
    SceneData::Object object;
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 3; ++row) object.world_from_object[column][row] = number();
    }
    object.mesh = static_cast<std::uint32_t>(some(9));
    object.flags = static_cast<std::uint32_t>(random() % (k_all_object_flags + 1));
    object.group = static_cast<std::uint32_t>(some(2));
    scene.objects.push_back(object);
  }
  scene.spare_objects = static_cast<std::uint32_t>(some(100));
  return scene;
}

std::string refusal_of(const SceneData& scene) {
  const auto decoded = decode_scene_data(encode_scene_data(scene));
  const auto* error = std::get_if<DecodeError>(&decoded);
  return error == nullptr ? "accepted" : error->reason;
}

TEST(SceneData, ComesBackAsItWasWritten) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 300; ++round) {
    const SceneData scene = random_scene(random);
    const auto decoded = decode_scene_data(encode_scene_data(scene));
    const auto* back = std::get_if<SceneData>(&decoded);
    ASSERT_NE(back, nullptr) << std::get<DecodeError>(decoded).reason;
    EXPECT_EQ(*back, scene);
  }
}

TEST(SceneData, IsRefusedWhereItsFormIsWrong) {
  SceneData scene = golden_scene();
  EXPECT_EQ(refusal_of(scene), "accepted");
  scene.objects[0].flags = 16;
  EXPECT_THAT(refusal_of(scene), HasSubstr("flags"));
  scene = golden_scene();
  scene.alpha_textures[0].width = 3;
  EXPECT_THAT(refusal_of(scene), HasSubstr("alpha_textures"));
  scene = golden_scene();
  scene.materials[0].alpha_mode = static_cast<SceneData::AlphaMode>(3);
  EXPECT_THAT(refusal_of(scene), HasSubstr("alpha_mode"));
  scene = golden_scene();
  scene.spare_objects = 0xffffffff;
  EXPECT_THAT(refusal_of(scene), HasSubstr("more than ids"));
}

TEST(SceneData, SurvivesCutsAndChangedBytes) {
  std::mt19937_64 random(2);
  const std::vector<std::uint8_t> whole = encode_scene_data(golden_scene());
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const std::vector<std::uint8_t> cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
    (void)decode_scene_data(cut);
  }
  for (int round = 0; round < 20000; ++round) {
    std::vector<std::uint8_t> changed = whole;
    for (std::uint64_t left = 1 + random() % 4; left > 0; --left)
      changed[random() % changed.size()] = static_cast<std::uint8_t>(random());
    (void)decode_scene_data(changed);
  }
}

TEST(SceneData, CountsASharedMeshForEachObject) {
  EXPECT_EQ(golden_scene().triangle_count(), 4u);
  EXPECT_EQ(golden_scene().object_count(), 5u);
}

// Of RFC 7693's function with 16 bytes: Python's hashlib.blake2b(b"abc", digest_size=16).hexdigest().
TEST(SceneDigests, AreThoseOfBlake2b) {
  const std::string text = "abc";
  const SceneDigest digest = digest_of({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  EXPECT_EQ(to_hex(digest), "cf4ab791c62b8d2b2109c90275287816");
  EXPECT_EQ(to_hex(digest_of({})), "cae66941d9efbd404e4d88758ea67670");
}

TEST(SceneDigests, CoverEveryByteAndEveryCount) {
  std::vector<std::uint8_t> bytes(2 * k_scene_chunk_bytes + 5, 7);
  const SceneOffer offer = offer_of(bytes, 10, 20);
  EXPECT_EQ(offer.chunk_digests.size(), 3u);
  EXPECT_EQ(chunk_of(bytes, 2).size(), 5u);
  EXPECT_EQ(offer.chunk_digests[0], offer.chunk_digests[1]);
  EXPECT_NE(offer_of(bytes, 11, 20).scene_digest, offer.scene_digest);
  EXPECT_NE(offer_of(bytes, 10, 21).scene_digest, offer.scene_digest);
  bytes.back() = 8;
  EXPECT_NE(offer_of(bytes, 10, 20).scene_digest, offer.scene_digest);
  SceneOffer swapped = offer;
  swapped.chunk_digests = {offer.chunk_digests[0], offer.chunk_digests[2], offer.chunk_digests[1]};
  EXPECT_NE(scene_digest_of(swapped), offer.scene_digest);
}

}  // namespace
}  // namespace sightline
