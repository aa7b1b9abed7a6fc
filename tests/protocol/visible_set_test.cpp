#include "protocol/visible_set.hpp"

#include <algorithm>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sample_messages.hpp"

namespace sightline {
namespace {

using testing::HasSubstr;

constexpr std::uint32_t k_object_count = 1'000'000;

VisibleSetFrame keyframe_of(const VisibleSet& set) {
  VisibleSetFrame frame;
  frame.set_seq = 1;
  frame.request_seq = 1;
  frame.visible_count = static_cast<std::uint32_t>(set.size());
  frame.bitmap = encode_keyframe(set);
  return frame;
}

VisibleSetFrame delta_of(const VisibleSet& base, const VisibleSet& set) {
  VisibleSetFrame frame = keyframe_of(set);
  frame.set_seq = 2;
  frame.base_seq = 1;
  frame.bitmap = encode_delta(base, set);
  return frame;
}

std::string reason_of(const std::variant<VisibleSet, DecodeError>& result) {
  const auto* error = std::get_if<DecodeError>(&result);
  return error == nullptr ? "decoded" : error->reason;
}

TEST(VisibleSet, HoldsTheIdsItWasMadeOf) {
  std::mt19937_64 random(1);
  const std::vector<ObjectId> ids = random_ids(5000, k_object_count, random);
  const VisibleSet set(ids);
  EXPECT_EQ(set.to_ids(), ids);
  EXPECT_EQ(set.size(), ids.size());
  for (const ObjectId id : ids) EXPECT_TRUE(set.contains(id));
  EXPECT_FALSE(set.contains(ObjectId{k_object_count}));
}

TEST(VisibleSet, UnitesAsSetsDo) {
  std::mt19937_64 random(2);
  const std::vector<ObjectId> a = random_ids(500, 2000, random);
  const std::vector<ObjectId> b = random_ids(500, 2000, random);
  std::vector<ObjectId> expected;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(expected));
  VisibleSet united(a);
  united.unite(VisibleSet(b));
  EXPECT_EQ(united.to_ids(), expected);
}

TEST(VisibleSetCodec, GivesBackKeyframesAndDeltas) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 100; ++round) {
    const auto object_count = static_cast<std::uint32_t>(1000 + random() % k_object_count);
    const std::vector<ObjectId> before = random_ids(random() % 900, object_count, random);
    const VisibleSet base(before);
    const VisibleSet set(
        with_changes(before, std::min<std::size_t>(before.size(), random() % 90), object_count, random));
    const auto keyframe = decode_visible_set(keyframe_of(set), nullptr, object_count);
    ASSERT_TRUE(std::holds_alternative<VisibleSet>(keyframe)) << reason_of(keyframe);
    EXPECT_EQ(std::get<VisibleSet>(keyframe), set);
    const auto delta = decode_visible_set(delta_of(base, set), &base, object_count);
    ASSERT_TRUE(std::holds_alternative<VisibleSet>(delta)) << reason_of(delta);
    EXPECT_EQ(std::get<VisibleSet>(delta), set);
  }
}

TEST(VisibleSetCodec, GivesBackTheEmptySetAndTheFullOne) {
  RoaringBitmap all;
  all.addRange(0, k_object_count);
  const VisibleSet empty;
  const VisibleSet full(all);
  for (const VisibleSet& set : {empty, full}) {
    for (const VisibleSet& base : {empty, full}) {
      const auto keyframe = decode_visible_set(keyframe_of(set), nullptr, k_object_count);
      EXPECT_EQ(std::get<VisibleSet>(keyframe), set);
      const auto delta = decode_visible_set(delta_of(base, set), &base, k_object_count);
      EXPECT_EQ(std::get<VisibleSet>(delta), set);
    }
  }
  EXPECT_LT(encode_keyframe(full).size(), 300u);  // 16 runs
}

TEST(VisibleSetCodec, NeedsTwoKilobytesForADeltaOfTwoHundredInAMillion) {
  std::mt19937_64 random(4);
  const std::vector<ObjectId> before = random_ids(5000, k_object_count, random);
  const VisibleSet base(before);
  const VisibleSet set(with_changes(before, 200, k_object_count, random));
  EXPECT_LE(encode(delta_of(base, set)).size(), 2048u);
}

TEST(VisibleSetCodec, NeverWritesRunsThatMakeItLonger) {
  std::mt19937_64 random(5);
  for (int round = 0; round < 50; ++round) {
    RoaringBitmap bitmap;
    for (const ObjectId id : random_ids(200, 300'000, random)) {
      bitmap.addRange(index_of(id), index_of(id) + 1 + random() % 12);
    }
    const std::size_t plain = bitmap.getSizeInBytes();
    EXPECT_LE(encode_keyframe(VisibleSet(bitmap)).size(), plain);
  }
}

TEST(VisibleSetCodec, RefusesADeltaWithoutItsBase) {
  const VisibleSet base;
  EXPECT_THAT(reason_of(decode_visible_set(delta_of(base, base), nullptr, 10)),
              HasSubstr("base is not held"));
}

TEST(VisibleSetCodec, RefusesADeltaAgainstAnotherBase) {
  std::mt19937_64 random(6);
  const VisibleSet base(random_ids(100, 1000, random));
  const VisibleSet other(random_ids(90, 1000, random));
  const VisibleSet set(random_ids(100, 1000, random));
  EXPECT_THAT(reason_of(decode_visible_set(delta_of(base, set), &other, 1000)), HasSubstr("not the base"));
}

TEST(VisibleSetCodec, RefusesIdsTheSceneDoesNotHave) {
  const VisibleSet set(std::vector<ObjectId>{ObjectId{3}, ObjectId{70'000}});
  EXPECT_EQ(reason_of(decode_visible_set(keyframe_of(set), nullptr, 70'001)), "decoded");
  EXPECT_THAT(reason_of(decode_visible_set(keyframe_of(set), nullptr, 70'000)),
              HasSubstr("object 70000 of 70000"));
  const VisibleSet base;
  EXPECT_THAT(reason_of(decode_visible_set(delta_of(base, set), &base, 70'000)), HasSubstr("object 70000"));
  EXPECT_THAT(
      reason_of(decode_visible_set(keyframe_of(VisibleSet(std::vector<ObjectId>{ObjectId{0}})), nullptr, 0)),
      HasSubstr("object 0 of 0"));
}

TEST(VisibleSetCodec, RefusesACountThatDoesNotMatch) {
  std::mt19937_64 random(7);
  VisibleSetFrame frame = keyframe_of(VisibleSet(random_ids(100, 1000, random)));
  frame.visible_count = 99;
  EXPECT_THAT(reason_of(decode_visible_set(frame, nullptr, 1000)), HasSubstr("not as many objects"));
}

TEST(VisibleSetCodec, RefusesABitmapThatIsNone) {
  VisibleSetFrame frame = keyframe_of(VisibleSet());
  frame.bitmap.clear();
  EXPECT_THAT(reason_of(decode_visible_set(frame, nullptr, 1000)), HasSubstr("bitmap"));
  frame.bitmap.assign(100, 0xFF);
  EXPECT_THAT(reason_of(decode_visible_set(frame, nullptr, 1000)), HasSubstr("bitmap"));
}

}  // namespace
}  // namespace sightline
