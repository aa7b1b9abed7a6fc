#include "protocol/scene_chunk_frame.hpp"

#include <algorithm>
#include <cstring>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "protocol/scene_chunks.hpp"
#include "sample_messages.hpp"

namespace sightline {
namespace {

constexpr std::size_t k_kind_count = std::variant_size_v<Message>;

/// Of a kind of message: its place in Message.
template <class Wanted>
std::size_t kind_of() {
  return Message(Wanted{}).index();
}

SceneChunk copy_of(const SceneChunkView& chunk) {
  return {chunk.scene_digest, chunk.index, {chunk.bytes.begin(), chunk.bytes.end()}};
}

/// Views and decodes a copy in a heap block of exactly its size, so that AddressSanitizer sees any read past
/// the end. Whether it was viewed as a chunk.
bool is_viewed_as_decoded(std::span<const std::byte> frame, const DecodeLimits& limits = {}) {
  const auto block = std::make_unique<std::byte[]>(frame.size());
  std::ranges::copy(frame, block.get());
  const std::span<const std::byte> exact(block.get(), frame.size());
  const auto viewed = view_scene_chunk(exact, limits);
  const auto decoded = decode(exact, limits);
  const auto* message = std::get_if<Message>(&decoded);
  const auto* chunk = message == nullptr ? nullptr : std::get_if<SceneChunk>(message);
  EXPECT_EQ(viewed.has_value(), chunk != nullptr);
  if (viewed && chunk != nullptr) {
    EXPECT_EQ(copy_of(*viewed), *chunk);
  }
  return viewed.has_value();
}

TEST(SceneChunkFrame, IsTheOneThatEncodeWrites) {
  std::mt19937_64 random(1);
  for (const std::size_t size : {std::size_t{1}, std::size_t{1000}, k_scene_chunk_bytes}) {
    SceneChunk chunk{{1, 2, 3}, 4, std::vector<std::uint8_t>(size)};
    for (std::uint8_t& byte : chunk.bytes) byte = static_cast<std::uint8_t>(random());
    EXPECT_TRUE(std::ranges::equal(encode_scene_chunk(chunk), encode(chunk))) << size;
  }
}

TEST(SceneChunkFrame, IsViewedAsItIsDecoded) {
  std::mt19937_64 random(2);
  for (int round = 0; round < 200; ++round)
    EXPECT_TRUE(is_viewed_as_decoded(encode(random_message(kind_of<SceneChunk>(), random))));
  EXPECT_TRUE(
      is_viewed_as_decoded(encode(SceneChunk{{}, 0, std::vector<std::uint8_t>(k_scene_chunk_bytes)})));
}

TEST(SceneChunkFrame, LeavesItsBytesWhereTheyAre) {
  const SceneChunk chunk{{7}, 3, std::vector<std::uint8_t>(5000, 9)};
  const Frame frame = encode_scene_chunk(chunk);
  const auto viewed = view_scene_chunk(frame);
  ASSERT_TRUE(viewed);
  const auto* begin = reinterpret_cast<const std::byte*>(viewed->bytes.data());
  EXPECT_GE(begin, frame.data());
  EXPECT_LE(begin + viewed->bytes.size(), frame.data() + frame.size());
}

TEST(SceneChunkFrame, IsNoOtherMessages) {
  std::mt19937_64 random(3);
  for (std::size_t kind = 0; kind < k_kind_count; ++kind) {
    if (kind == kind_of<SceneChunk>()) continue;
    for (int round = 0; round < 20; ++round)
      EXPECT_FALSE(is_viewed_as_decoded(encode(random_message(kind, random))));
  }
}

TEST(SceneChunkFrame, IsRefusedAboveTheLimits) {
  const Bytes frame = encode(SceneChunk{{}, 0, std::vector<std::uint8_t>(1000)});
  DecodeLimits limits;
  limits.max_frame_bytes = frame.size();
  EXPECT_TRUE(is_viewed_as_decoded(frame, limits));
  limits.max_frame_bytes = frame.size() - 1;
  EXPECT_FALSE(is_viewed_as_decoded(frame, limits));
  EXPECT_FALSE(
      is_viewed_as_decoded(encode(SceneChunk{{}, 0, std::vector<std::uint8_t>(k_scene_chunk_bytes + 1)})));
  EXPECT_FALSE(is_viewed_as_decoded(encode(SceneChunk{})));
}

TEST(SceneChunkFrame, IsLeftToDecodeWhereItIsNotAligned) {
  const Bytes frame = encode(SceneChunk{{5}, 6, {7, 8, 9}});
  Bytes shifted(frame.size() + 1);
  std::ranges::copy(frame, shifted.begin() + 1);
  const auto unaligned = std::span<const std::byte>(shifted).subspan(1);
  EXPECT_FALSE(view_scene_chunk(unaligned));
  EXPECT_TRUE(std::holds_alternative<Message>(decode(unaligned)));
}

TEST(SceneChunkFrame, IsViewedAsDecodedWhateverTheBytes) {
  std::mt19937_64 random(4);
  const Bytes frame = encode(SceneChunk{{1, 2, 3}, 4, std::vector<std::uint8_t>(100, 5)});
  for (std::size_t size = 0; size < frame.size(); ++size)
    EXPECT_FALSE(is_viewed_as_decoded(std::span(frame).first(size)));
  std::size_t accepted = 0, refused = 0;
  for (int round = 0; round < 20'000; ++round) {
    Bytes changed = frame;
    for (std::uint64_t left = 1 + random() % 3; left > 0; --left)
      changed[random() % changed.size()] ^= static_cast<std::byte>(1u << random() % 8);
    ++(is_viewed_as_decoded(changed) ? accepted : refused);
  }
  EXPECT_GT(accepted, 1000u);
  EXPECT_GT(refused, 1000u);
  for (std::size_t place = 0; place + 4 <= frame.size(); place += 4) {
    for (const std::uint32_t value : {0u, 1u, 0x10000u, 0x7FFFFFFFu, 0x80000000u, 0xFFFFFFFCu, 0xFFFFFFFFu}) {
      Bytes changed = frame;
      std::memcpy(changed.data() + place, &value, sizeof value);
      (void)is_viewed_as_decoded(changed);
    }
  }
}

}  // namespace
}  // namespace sightline
