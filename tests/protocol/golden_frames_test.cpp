// The golden frames are what docs/protocol.md shows and what a client in another language can be tested with.
// They change only with the protocol version. To write them anew: SIGHTLINE_WRITE_GOLDEN=1 test_protocol
// --gtest_filter='GoldenFrames.*'

#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <sstream>

#include <gtest/gtest.h>

#include "protocol/codec.hpp"
#include "sample_messages.hpp"

namespace sightline {
namespace {

std::string file_of(const std::string& name) {
  return std::string(SIGHTLINE_GOLDEN_DIR) + "/" + name + ".hex";
}

/// 16 bytes a line; lines that begin with # say something to a reader.
std::string to_hex_text(const Bytes& frame) {
  std::ostringstream text;
  text << std::hex << std::setfill('0');
  for (std::size_t i = 0; i < frame.size(); ++i) {
    text << std::setw(2) << std::to_integer<int>(frame[i])
         << (i % 16 == 15 || i + 1 == frame.size() ? '\n' : ' ');
  }
  return text.str();
}

Bytes read_hex_file(const std::string& file) {
  std::ifstream stream(file);
  EXPECT_TRUE(stream) << file;
  Bytes frame;
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream words(line);
    for (std::string word; words >> word;)
      frame.push_back(static_cast<std::byte>(std::stoi(word, nullptr, 16)));
  }
  return frame;
}

class GoldenFrames : public testing::TestWithParam<NamedMessage> {
 protected:
  void SetUp() override {
    if (std::getenv("SIGHTLINE_WRITE_GOLDEN") == nullptr) return;
    std::ofstream stream(file_of(GetParam().name));
    stream << "# " << GetParam().name << ", protocol version " << k_protocol_version << "\n"
           << to_hex_text(encode(GetParam().message));
  }
};

TEST_P(GoldenFrames, DecodeToTheirMessage) {
  const auto result = decode(read_hex_file(file_of(GetParam().name)));
  ASSERT_TRUE(std::holds_alternative<Message>(result)) << std::get<DecodeError>(result).reason;
  EXPECT_EQ(std::get<Message>(result), GetParam().message);
}

TEST_P(GoldenFrames, AreWrittenBitForBit) {
  EXPECT_EQ(to_hex_text(encode(GetParam().message)), to_hex_text(read_hex_file(file_of(GetParam().name))));
}

INSTANTIATE_TEST_SUITE_P(Protocol, GoldenFrames, testing::ValuesIn(golden_messages()),
                         [](const auto& test) { return test.param.name; });

TEST(GoldenVisibleSets, DecodeToTheirIds) {
  const auto frame_of = [](const char* name) {
    return std::get<VisibleSetFrame>(std::get<Message>(decode(read_hex_file(file_of(name)))));
  };
  const auto ids = [](std::initializer_list<std::uint32_t> indices) {
    std::vector<ObjectId> list;
    for (const std::uint32_t index : indices) list.push_back(ObjectId{index});
    return list;
  };
  const auto keyframe = decode_visible_set(frame_of("visible_set_keyframe"), nullptr, 70'001);
  ASSERT_TRUE(std::holds_alternative<VisibleSet>(keyframe));
  EXPECT_EQ(std::get<VisibleSet>(keyframe).to_ids(), ids({1, 2, 3, 10, 70'000}));
  const auto delta =
      decode_visible_set(frame_of("visible_set_delta"), &std::get<VisibleSet>(keyframe), 70'001);
  ASSERT_TRUE(std::holds_alternative<VisibleSet>(delta));
  EXPECT_EQ(std::get<VisibleSet>(delta).to_ids(), ids({1, 2, 4, 10, 70'000}));
}

}  // namespace
}  // namespace sightline
