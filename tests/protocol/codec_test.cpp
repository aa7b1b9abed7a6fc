#include "protocol/codec.hpp"

#include <cstring>
#include <memory>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sample_messages.hpp"

namespace sightline {
namespace {

using testing::HasSubstr;

constexpr std::size_t k_kind_count = std::variant_size_v<Message>;

/// Decodes a copy in a heap block of exactly its size, so that AddressSanitizer sees any read past the end.
std::variant<Message, DecodeError> decode_exact(std::span<const std::byte> frame) {
  const auto block = std::make_unique<std::byte[]>(frame.size());
  std::copy(frame.begin(), frame.end(), block.get());
  return decode({block.get(), frame.size()});
}

bool is_refused(std::span<const std::byte> frame) {
  return std::holds_alternative<DecodeError>(decode_exact(frame));
}

std::string reason_of(const std::variant<Message, DecodeError>& result) {
  const auto* error = std::get_if<DecodeError>(&result);
  return error == nullptr ? "decoded" : error->reason;
}

TEST(Codec, GivesBackEveryMessage) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 300; ++round) {
    for (std::size_t kind = 0; kind < k_kind_count; ++kind) {
      const Message message = random_message(kind, random);
      ASSERT_EQ(message.index(), kind);
      const auto result = decode_exact(encode(message));
      ASSERT_TRUE(std::holds_alternative<Message>(result)) << "kind " << kind << ": " << reason_of(result);
      EXPECT_EQ(std::get<Message>(result), message) << "kind " << kind;
    }
  }
}

TEST(Codec, WritesTheSameBytesForTheSameMessage) {
  std::mt19937_64 random(2);
  for (std::size_t kind = 0; kind < k_kind_count; ++kind) {
    const Message message = random_message(kind, random);
    EXPECT_EQ(encode(message), encode(message));
  }
}

TEST(Codec, RefusesEveryProperPrefix) {
  std::mt19937_64 random(3);
  for (std::size_t kind = 0; kind < k_kind_count; ++kind) {
    for (int round = 0; round < 5; ++round) {
      const Bytes frame = encode(random_message(kind, random));
      for (std::size_t length = 0; length < frame.size(); ++length) {
        EXPECT_TRUE(is_refused(std::span(frame).first(length)))
            << "kind " << kind << ", " << length << " of " << frame.size() << " bytes";
      }
    }
  }
}

// FlatBuffers has no length of its own and finds everything from the front, so whole words behind a message
// do no harm; docs/protocol.md allows them, for writers that pad.
TEST(Codec, IgnoresWholeWordsBehindAMessageAndRefusesOddBytes) {
  for (const auto& [name, message] : golden_messages()) {
    for (std::size_t extra = 1; extra <= 16; ++extra) {
      Bytes frame = encode(message);
      frame.resize(frame.size() + extra, std::byte{0xA5});
      const auto result = decode_exact(frame);
      if (extra % 4 == 0) {
        ASSERT_TRUE(std::holds_alternative<Message>(result)) << name << ": " << reason_of(result);
        EXPECT_EQ(std::get<Message>(result), message);
      } else {
        EXPECT_TRUE(std::holds_alternative<DecodeError>(result)) << name;
      }
    }
  }
}

TEST(Codec, ReadsAFrameAtAnyAddress) {
  for (const auto& [name, message] : golden_messages()) {
    const Bytes frame = encode(message);
    for (std::size_t shift = 0; shift < 8; ++shift) {
      Bytes shifted(shift);
      shifted.insert(shifted.end(), frame.begin(), frame.end());
      const auto result = decode(std::span(shifted).subspan(shift));
      ASSERT_TRUE(std::holds_alternative<Message>(result)) << name << ": " << reason_of(result);
      EXPECT_EQ(std::get<Message>(result), message);
    }
  }
}

TEST(Codec, RefusesAnotherFileIdentifier) {
  Bytes frame = encode(Ping{1, 2.0});
  ASSERT_EQ(std::memcmp(frame.data() + 4, "SLN1", 4), 0);
  frame[7] = std::byte{'2'};
  EXPECT_THAT(reason_of(decode_exact(frame)), HasSubstr("SLN1"));
}

TEST(Codec, RefusesAFrameOverTheLimit) {
  const Bytes frame = encode(Ping{1, 2.0});
  DecodeLimits limits;
  limits.max_frame_bytes = frame.size();
  EXPECT_TRUE(std::holds_alternative<Message>(decode(frame, limits)));
  limits.max_frame_bytes = frame.size() - 1;
  EXPECT_THAT(reason_of(decode(frame, limits)), HasSubstr("bytes, at most"));
}

TEST(Codec, RefusesMoreMovesThanTheLimit) {
  std::mt19937_64 random(4);
  ViewRequest request;
  request.request_seq = 1;
  request.eyes = {random_eye(random)};
  for (std::uint32_t i = 0; i < 5; ++i) request.moves.push_back({ObjectId{i}, glm::dmat4x3(1.0)});
  DecodeLimits limits;
  limits.max_moves = 5;
  EXPECT_TRUE(std::holds_alternative<Message>(decode(encode(request), limits)));
  limits.max_moves = 4;
  EXPECT_THAT(reason_of(decode(encode(request), limits)), HasSubstr("moves: 5, at most 4"));
}

TEST(Codec, RefusesATextOverTheLimit) {
  DecodeLimits limits;
  limits.max_text_bytes = 4;
  EXPECT_TRUE(std::holds_alternative<Message>(decode(encode(Hello{1, "four", {}}), limits)));
  EXPECT_THAT(reason_of(decode(encode(Hello{1, "fives", {}}), limits)), HasSubstr("client_name"));
}

TEST(Codec, CleansAndCutsTheTextsItWrites) {
  Refusal refusal;
  refusal.text = "two\nlines \xFF" + std::string(5000, 'x');
  const auto result = decode(encode(refusal));
  ASSERT_TRUE(std::holds_alternative<Message>(result)) << reason_of(result);
  const std::string& text = std::get<Refusal>(std::get<Message>(result)).text;
  EXPECT_EQ(text.size(), 1024u);
  EXPECT_TRUE(text.starts_with("two lines ?xxx"));
}

TEST(Codec, RefusesControlCharactersInATextOfAPeer) {
  Bytes frame = encode(Hello{1, "name", {}});
  const std::string_view view(reinterpret_cast<const char*>(frame.data()), frame.size());
  const std::size_t place = view.find("name");
  ASSERT_NE(place, std::string_view::npos);
  frame[place] = std::byte{0x1B};
  EXPECT_THAT(reason_of(decode_exact(frame)), HasSubstr("client_name"));
}

TEST(Codec, ReadsAHelloAndARefusalOfAnotherVersion) {
  const auto hello = decode(encode(Hello{k_protocol_version + 1, "newer", {}}));
  ASSERT_TRUE(std::holds_alternative<Message>(hello)) << reason_of(hello);
  EXPECT_EQ(std::get<Hello>(std::get<Message>(hello)).version, k_protocol_version + 1);

  Refusal refusal;
  refusal.server_version = k_protocol_version + 1;
  refusal.reason = static_cast<RefusalReason>(200);
  EXPECT_TRUE(std::holds_alternative<Message>(decode(encode(refusal))));
  refusal.server_version = k_protocol_version;
  EXPECT_THAT(reason_of(decode(encode(refusal))), HasSubstr("reason"));
}

}  // namespace
}  // namespace sightline
