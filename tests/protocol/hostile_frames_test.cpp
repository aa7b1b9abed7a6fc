// Bytes nobody wrote on purpose: whatever decodes must be a message that this version could have sent.

#include <cmath>
#include <cstring>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "protocol/codec.hpp"
#include "protocol/message_checks.hpp"
#include "sample_messages.hpp"

namespace sightline {
namespace {

constexpr std::size_t k_kind_count = std::variant_size_v<Message>;

/// Decodes from a heap block of exactly its size; true when it was accepted, after checking what it was read
/// as.
bool survives(const Bytes& frame) {
  const auto block = std::make_unique<std::byte[]>(frame.size());
  std::copy(frame.begin(), frame.end(), block.get());
  const auto result = decode({block.get(), frame.size()});
  const auto* message = std::get_if<Message>(&result);
  if (message == nullptr) {
    EXPECT_FALSE(std::get<DecodeError>(result).reason.empty());
    return false;
  }
  EXPECT_EQ(first_fault(*message), std::nullopt);
  const auto again = decode(encode(*message));
  EXPECT_TRUE(std::holds_alternative<Message>(again));
  if (const auto* frame_read = std::get_if<VisibleSetFrame>(message)) {
    const auto set = decode_visible_set(*frame_read, nullptr, 200'000);
    if (const auto* ids = std::get_if<VisibleSet>(&set)) {
      EXPECT_EQ(ids->size(), frame_read->visible_count);
    }
  }
  return true;
}

TEST(HostileFrames, RefusesRandomBytes) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 20'000; ++round) {
    Bytes frame(random() % 256);
    for (std::byte& byte : frame) byte = static_cast<std::byte>(random());
    if (frame.size() >= 8 && round % 2 == 0) std::memcpy(frame.data() + 4, "SLN1", 4);
    EXPECT_FALSE(survives(frame));
  }
}

TEST(HostileFrames, SurvivesRandomBitFlips) {
  std::mt19937_64 random(2);
  std::size_t accepted = 0;
  std::size_t refused = 0;
  for (int round = 0; round < 1'000; ++round) {
    for (std::size_t kind = 0; kind < k_kind_count; ++kind) {
      Bytes frame = encode(random_message(kind, random));
      for (std::uint64_t left = 1 + random() % 4; left > 0; --left) {
        frame[random() % frame.size()] ^= static_cast<std::byte>(1u << random() % 8);
      }
      (survives(frame) ? accepted : refused) += 1;
    }
  }
  // A flip within a sequence number gives another valid message, one within an offset does not.
  EXPECT_GT(accepted, 100u);
  EXPECT_GT(refused, 100u);
}

// Every count, length and offset is among these words.
TEST(HostileFrames, SurvivesHugeNumbersInEveryWord) {
  std::mt19937_64 random(3);
  for (std::size_t kind = 0; kind < k_kind_count; ++kind) {
    const Bytes frame = encode(random_message(kind, random));
    for (std::size_t place = 0; place + 4 <= frame.size(); place += 4) {
      for (const std::uint32_t value :
           {0u, 1u, 0x10000u, 0x7FFFFFFFu, 0x80000000u, 0xFFFFFFFCu, 0xFFFFFFFFu}) {
        Bytes changed = frame;
        std::memcpy(changed.data() + place, &value, sizeof value);
        survives(changed);
      }
    }
  }
}

/// Where the list or text with this content begins, less its four bytes of length.
std::size_t place_of_length(const Bytes& frame, std::string_view content) {
  const std::string_view view(reinterpret_cast<const char*>(frame.data()), frame.size());
  const std::size_t place = view.find(content);
  EXPECT_NE(place, std::string_view::npos);
  return place - 4;
}

TEST(HostileFrames, RefusesHugeCounts) {
  std::mt19937_64 random(4);
  const auto refused_with_huge_length = [](Bytes frame, std::string_view content) {
    const std::uint32_t huge = 0x7FFFFFF0;
    std::memcpy(frame.data() + place_of_length(frame, content), &huge, sizeof huge);
    return !survives(frame);
  };
  EXPECT_TRUE(refused_with_huge_length(encode(Hello{1, "my name", {}}), "my name"));

  ViewRequest request;
  request.request_seq = 1;
  request.eyes = {random_eye(random)};
  const double first_entry = request.eyes[0].camera_from_world[0][0];
  EXPECT_TRUE(refused_with_huge_length(
      encode(request), std::string_view(reinterpret_cast<const char*>(&first_entry), sizeof first_entry)));

  request.moves = {{ObjectId{0x12345678}, glm::dmat4x3(1.0)}};
  EXPECT_TRUE(refused_with_huge_length(encode(request), "\x78\x56\x34\x12"));

  VisibleSetFrame frame;
  frame.set_seq = 1;
  frame.request_seq = 1;
  frame.bitmap.assign({'b', 'i', 't', 'm', 'a', 'p', '0', '1'});
  EXPECT_TRUE(refused_with_huge_length(encode(frame), "bitmap01"));
}

// FlatBuffers' verifier checks that a list's length is aligned, not that its elements are.
TEST(HostileFrames, RefusesAListWhoseElementsAreNotAligned) {
  ViewRequest request;
  request.request_seq = 1;
  request.eyes.resize(1);
  // The lower half of this entry reads as a length of 1, once the list is taken to begin four bytes later.
  const double first_entry = std::nextafter(1.0, 2.0);
  request.eyes[0].camera_from_world[0][0] = first_entry;
  Bytes frame = encode(request);
  frame.resize(frame.size() + 8);
  const std::size_t place = place_of_length(
      frame, std::string_view(reinterpret_cast<const char*>(&first_entry), sizeof first_entry));

  std::size_t moved = 0;
  for (std::size_t field = 8; field < place; field += 4) {
    std::uint32_t offset = 0;
    std::memcpy(&offset, frame.data() + field, sizeof offset);
    if (field + offset != place) continue;
    offset += 4;
    std::memcpy(frame.data() + field, &offset, sizeof offset);
    ++moved;
  }
  ASSERT_EQ(moved, 1u);
  const auto result = decode(frame);
  ASSERT_TRUE(std::holds_alternative<DecodeError>(result));
  EXPECT_EQ(std::get<DecodeError>(result).reason, "eyes: not aligned");
}

TEST(HostileFrames, RefusesAnUnknownMessageType) {
  const Bytes frame = encode(Goodbye{1});
  std::size_t refused = 0;
  // The type is one byte of value 8 in the envelope; finding it by trial keeps the test apart from the
  // layout.
  for (std::size_t place = 8; place < frame.size(); ++place) {
    if (frame[place] != std::byte{8}) continue;
    Bytes changed = frame;
    changed[place] = std::byte{99};
    const auto result = decode(changed);
    const auto* error = std::get_if<DecodeError>(&result);
    if (error != nullptr && error->reason == "unknown message type 99") ++refused;
  }
  EXPECT_EQ(refused, 1u);
}

}  // namespace
}  // namespace sightline
