#include "protocol/roaring_format.hpp"

#include <cstring>
#include <memory>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "protocol/visible_set.hpp"

namespace sightline {
namespace {

using testing::HasSubstr;
using BitmapBytes = std::vector<std::uint8_t>;

std::variant<RoaringSummary, DecodeError> check_exact(std::span<const std::uint8_t> bytes) {
  const auto block = std::make_unique<std::uint8_t[]>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), block.get());
  return check_roaring({block.get(), bytes.size()});
}

std::string verdict(const BitmapBytes& bytes) {
  const auto result = check_exact(bytes);
  const auto* error = std::get_if<DecodeError>(&result);
  return error == nullptr ? "accepted" : error->reason;
}

/// Writes a bitmap by hand, right or wrong.
struct Writer {
  Writer& u8(std::uint32_t value) {
    bytes.push_back(static_cast<std::uint8_t>(value));
    return *this;
  }
  Writer& u16(std::uint32_t value) { return u8(value & 0xFF).u8(value >> 8 & 0xFF); }
  Writer& u32(std::uint32_t value) { return u16(value & 0xFFFF).u16(value >> 16); }
  Writer& zeros(std::size_t count) {
    bytes.resize(bytes.size() + count);
    return *this;
  }
  BitmapBytes bytes;
};

/// One array container, key 0.
BitmapBytes array_of(std::initializer_list<std::uint32_t> values, std::uint32_t cardinality) {
  Writer writer;
  writer.u32(12346).u32(1).u16(0).u16(cardinality - 1).u32(16);
  for (const std::uint32_t value : values) writer.u16(value);
  return writer.bytes;
}

/// One run container, key 0; runs are start and length less one.
BitmapBytes runs_of(std::initializer_list<std::pair<std::uint32_t, std::uint32_t>> runs,
                    std::uint32_t cardinality) {
  Writer writer;
  writer.u32(12347).u8(1).u16(0).u16(cardinality - 1).u16(static_cast<std::uint32_t>(runs.size()));
  for (const auto& [start, length_less_one] : runs) writer.u16(start).u16(length_less_one);
  return writer.bytes;
}

/// One bitset container, key 0, with the first `bits_set` bits set.
BitmapBytes bitset_of(std::uint32_t bits_set, std::uint32_t cardinality) {
  Writer writer;
  writer.u32(12346).u32(1).u16(0).u16(cardinality - 1).u32(16).zeros(8192);
  for (std::uint32_t bit = 0; bit < bits_set; ++bit) {
    writer.bytes[16 + bit / 8] |= static_cast<std::uint8_t>(1u << bit % 8);
  }
  return writer.bytes;
}

RoaringBitmap random_bitmap(std::mt19937_64& random) {
  RoaringBitmap bitmap;
  for (std::uint64_t container = random() % 8; container > 0; --container) {
    const auto key = static_cast<std::uint32_t>(random() % 65536) << 16;
    switch (random() % 3) {
      case 0:
        for (std::uint64_t left = 1 + random() % 300; left > 0; --left) {
          bitmap.add(key | static_cast<std::uint32_t>(random() & 0xFFFF));
        }
        break;
      case 1:
        for (int left = 0; left < 9000; ++left)
          bitmap.add(key | static_cast<std::uint32_t>(random() & 0xFFFF));
        break;
      default: {
        const std::uint64_t start = key + random() % 30000;
        bitmap.addRange(start, start + 1 + random() % 35000);
        bitmap.addRange(std::uint64_t{key} + 65530, std::uint64_t{key} + 65536);
      }
    }
  }
  if (random() % 2 == 0) bitmap.runOptimize();
  return bitmap;
}

BitmapBytes bytes_of(const RoaringBitmap& bitmap) {
  BitmapBytes bytes(bitmap.getSizeInBytes());
  bitmap.write(reinterpret_cast<char*>(bytes.data()));
  return bytes;
}

TEST(RoaringFormat, AcceptsWhatCRoaringWrites) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 100; ++round) {
    const RoaringBitmap bitmap = random_bitmap(random);
    const BitmapBytes bytes = bytes_of(bitmap);
    ASSERT_EQ(verdict(bytes), "accepted");
    const auto summary = std::get<RoaringSummary>(check_exact(bytes));
    EXPECT_EQ(summary.cardinality, bitmap.cardinality());
    EXPECT_EQ(summary.largest, bitmap.isEmpty() ? 0 : bitmap.maximum());
  }
}

TEST(RoaringFormat, AcceptsTheLargestBitmap) {
  RoaringBitmap bitmap;
  bitmap.addRange(0, std::uint64_t{1} << 32);
  EXPECT_EQ(verdict(bytes_of(bitmap)), "accepted");
  bitmap.runOptimize();
  EXPECT_EQ(verdict(bytes_of(bitmap)), "accepted");
  EXPECT_EQ(std::get<RoaringSummary>(check_roaring(bytes_of(bitmap))).cardinality, std::uint64_t{1} << 32);
}

TEST(RoaringFormat, RefusesEveryProperPrefixAndOneByteMore) {
  std::mt19937_64 random(2);
  for (int round = 0; round < 10; ++round) {
    BitmapBytes bytes = bytes_of(random_bitmap(random));
    const std::size_t step = 1 + bytes.size() / 500;
    for (std::size_t length = 0; length < bytes.size(); length += step) {
      EXPECT_TRUE(std::holds_alternative<DecodeError>(check_exact(std::span(bytes).first(length)))) << length;
    }
    EXPECT_TRUE(std::holds_alternative<DecodeError>(check_exact(std::span(bytes).first(bytes.size() - 1))));
    bytes.push_back(0);
    EXPECT_THAT(verdict(bytes), HasSubstr("after the last container"));
  }
}

TEST(RoaringFormat, RefusesWrongHeaders) {
  EXPECT_THAT(verdict(Writer().u32(12345).u32(0).bytes), HasSubstr("unknown cookie"));
  EXPECT_THAT(verdict(Writer().u32(12346 | 1 << 16).u32(0).bytes), HasSubstr("unknown cookie"));
  EXPECT_THAT(verdict(Writer().u32(12346).u32(65537).bytes), HasSubstr("more than 65536"));
  EXPECT_THAT(verdict(Writer().u32(12346).u32(0xFFFFFFFF).bytes), HasSubstr("more than 65536"));
  EXPECT_THAT(verdict(Writer().u32(12346).u32(65536).bytes), HasSubstr("headers cut short"));
  EXPECT_THAT(verdict(Writer().u32(0xFFFF0000 | 12347).bytes), HasSubstr("run flags cut short"));
  EXPECT_THAT(verdict(Writer().u32(12347).u8(0x03).u16(0).u16(0).u16(1).u16(5).u16(0).bytes),
              HasSubstr("run flags of containers"));
  EXPECT_EQ(verdict(Writer().u32(12346).u32(0).bytes), "accepted");
}

TEST(RoaringFormat, RefusesWrongArrays) {
  EXPECT_EQ(verdict(array_of({1, 2, 65535}, 3)), "accepted");
  EXPECT_THAT(verdict(array_of({1, 3, 2}, 3)), HasSubstr("not ascending"));
  EXPECT_THAT(verdict(array_of({1, 2, 2}, 3)), HasSubstr("not ascending"));
  EXPECT_THAT(verdict(array_of({1, 2}, 3)), HasSubstr("cut short"));
  EXPECT_THAT(verdict(array_of({1, 2, 3}, 2)), HasSubstr("after the last"));
}

TEST(RoaringFormat, RefusesWrongBitsets) {
  EXPECT_EQ(verdict(bitset_of(5000, 5000)), "accepted");
  EXPECT_EQ(verdict(bitset_of(65536, 65536)), "accepted");
  EXPECT_THAT(verdict(bitset_of(5000, 5001)), HasSubstr("another cardinality"));
  EXPECT_THAT(verdict(bitset_of(4999, 5000)), HasSubstr("another cardinality"));
  EXPECT_THAT(verdict(bitset_of(0, 65536)), HasSubstr("another cardinality"));
}

TEST(RoaringFormat, RefusesWrongRuns) {
  EXPECT_EQ(verdict(runs_of({{0, 9}, {20, 4}}, 15)), "accepted");
  EXPECT_EQ(verdict(runs_of({{0, 65535}}, 65536)), "accepted");
  EXPECT_THAT(verdict(runs_of({}, 1)), HasSubstr("without runs"));
  EXPECT_THAT(verdict(runs_of({{20, 4}, {0, 9}}, 15)), HasSubstr("unsorted"));
  EXPECT_THAT(verdict(runs_of({{0, 9}, {5, 9}}, 20)), HasSubstr("overlap"));
  EXPECT_THAT(verdict(runs_of({{0, 9}, {10, 9}}, 20)), HasSubstr("touch"));
  EXPECT_THAT(verdict(runs_of({{65530, 6}}, 7)), HasSubstr("over its end"));
  EXPECT_THAT(verdict(runs_of({{65535, 0}, {65535, 65535}}, 2)), HasSubstr("unsorted"));
  EXPECT_THAT(verdict(runs_of({{0, 9}}, 11)), HasSubstr("another cardinality"));
  // A count of runs that the bytes do not hold.
  EXPECT_THAT(verdict(Writer().u32(12347).u8(1).u16(0).u16(0).u16(65535).u16(0).u16(0).bytes),
              HasSubstr("cut short"));
}

TEST(RoaringFormat, RefusesKeysOutOfOrder) {
  for (const std::uint32_t second_key : {4u, 5u}) {
    const BitmapBytes bytes =
        Writer().u32(12346).u32(2).u16(5).u16(0).u16(second_key).u16(0).u32(24).u32(26).u16(1).u16(1).bytes;
    EXPECT_THAT(verdict(bytes), HasSubstr("keys not ascending"));
  }
}

TEST(RoaringFormat, RefusesOffsetsThatPointElsewhere) {
  for (const std::uint32_t offset : {0u, 15u, 18u, 0xFFFFFFFFu}) {
    BitmapBytes bytes = array_of({1, 2, 3}, 3);
    std::memcpy(bytes.data() + 12, &offset, sizeof offset);
    EXPECT_THAT(verdict(bytes), HasSubstr("not where its offset says"));
  }
}

TEST(RoaringFormat, SurvivesRandomChangesAndVouchesForWhatItAccepts) {
  std::mt19937_64 random(3);
  std::size_t accepted = 0;
  for (int round = 0; round < 300; ++round) {
    BitmapBytes bytes = bytes_of(random_bitmap(random));
    const std::size_t within = random() % 2 == 0 ? bytes.size() : std::min<std::size_t>(bytes.size(), 64);
    bytes[random() % within] ^= static_cast<std::uint8_t>(1u << random() % 8);
    const auto result = check_exact(bytes);
    if (const auto* summary = std::get_if<RoaringSummary>(&result)) {
      ++accepted;
      const RoaringBitmap bitmap =
          RoaringBitmap::readSafe(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      EXPECT_EQ(bitmap.cardinality(), summary->cardinality);
      // A bitmap built up again from its own ids is well formed by construction.
      std::vector<std::uint32_t> ids(bitmap.cardinality());
      bitmap.toUint32Array(ids.data());
      EXPECT_EQ(RoaringBitmap(ids.size(), ids.data()), bitmap);
    }
  }
  EXPECT_GT(accepted, 10u);
}

}  // namespace
}  // namespace sightline
