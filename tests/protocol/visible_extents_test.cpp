// The part of a visible set's frame that says in which directions its objects were seen.

#include <algorithm>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "protocol/visible_set.hpp"
#include "sample_messages.hpp"

namespace sightline {
namespace {

using testing::HasSubstr;

constexpr std::uint32_t k_object_count = 100'000;

DirectionExtent random_extent(std::mt19937_64& random) {
  const auto byte = [&] { return static_cast<std::uint8_t>(random()); };
  const std::uint8_t a = byte(), b = byte();
  return {byte(), byte(), std::min(a, b), std::max(a, b), byte()};
}

VisibleSet set_of(const std::vector<ObjectId>& ids, std::mt19937_64& random) {
  VisibleSet set(ids);
  std::vector<DirectionExtent> extents;
  for (std::size_t i = 0; i < ids.size(); ++i) extents.push_back(random_extent(random));
  set.set_extents(std::move(extents));
  return set;
}

VisibleSetFrame frame_of(const VisibleSet* base, const VisibleSet& set) {
  VisibleSetFrame frame;
  frame.set_seq = 2;
  frame.request_seq = 1;
  frame.base_seq = base == nullptr ? 0 : 1;
  frame.visible_count = static_cast<std::uint32_t>(set.size());
  frame.bitmap = base == nullptr ? encode_keyframe(set) : encode_delta(*base, set);
  EncodedExtents encoded = encode_extents(base, set);
  frame.extents_of = std::move(encoded.ids);
  frame.extents = std::move(encoded.cells);
  return frame;
}

VisibleSet decoded(const VisibleSetFrame& frame, const VisibleSet* base) {
  const auto result = decode_visible_set(frame, base, k_object_count);
  const auto* error = std::get_if<DecodeError>(&result);
  EXPECT_EQ(error, nullptr) << error->reason;
  return error == nullptr ? std::get<VisibleSet>(result) : VisibleSet();
}

std::vector<DirectionExtent> extents_of(const VisibleSet& set) {
  return {set.extents().begin(), set.extents().end()};
}

std::string reason_of(const VisibleSetFrame& frame, const VisibleSet* base = nullptr) {
  const auto result = decode_visible_set(frame, base, k_object_count);
  const auto* error = std::get_if<DecodeError>(&result);
  return error == nullptr ? std::string("decoded") : error->reason;
}

TEST(VisibleExtents, ComeBackFromKeyframesAndDeltas) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 100; ++round) {
    const std::vector<ObjectId> before = random_ids(random() % 500, k_object_count, random);
    const VisibleSet base = set_of(before, random);
    VisibleSet set = set_of(
        with_changes(before, std::min<std::size_t>(before.size(), random() % 60), k_object_count, random),
        random);
    // Most as they were.
    std::vector<DirectionExtent> extents = extents_of(set);
    const std::vector<ObjectId> ids = set.to_ids();
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const auto at = std::lower_bound(before.begin(), before.end(), ids[i]);
      if (random() % 4 != 0 && at != before.end() && *at == ids[i])
        extents[i] = base.extents()[static_cast<std::size_t>(at - before.begin())];
    }
    set.set_extents(extents);

    EXPECT_EQ(extents_of(decoded(frame_of(nullptr, set), nullptr)), extents);
    const VisibleSet from_delta = decoded(frame_of(&base, set), &base);
    EXPECT_EQ(from_delta, set);
    EXPECT_EQ(extents_of(from_delta), extents);
  }
}

TEST(VisibleExtents, CostNothingWhereTheyStay) {
  std::mt19937_64 random(2);
  const std::vector<ObjectId> before = random_ids(400, k_object_count, random);
  const VisibleSet base = set_of(before, random);
  const EncodedExtents same = encode_extents(&base, base);
  EXPECT_TRUE(same.ids.empty() && same.cells.empty());

  // Ten objects leave, nobody comes.
  std::vector<ObjectId> fewer = before;
  std::vector<DirectionExtent> extents = extents_of(base);
  fewer.erase(fewer.begin() + 50, fewer.begin() + 60);
  extents.erase(extents.begin() + 50, extents.begin() + 60);
  VisibleSet rest(fewer);
  rest.set_extents(extents);
  const EncodedExtents left = encode_extents(&base, rest);
  EXPECT_TRUE(left.ids.empty() && left.cells.empty());
  EXPECT_EQ(extents_of(decoded(frame_of(&base, rest), &base)), extents);

  extents[7].distance ^= 1;
  rest.set_extents(extents);
  EXPECT_EQ(encode_extents(&base, rest).cells.size(), 5u);
  EXPECT_EQ(encode_extents(nullptr, rest).cells.size(), 5u * fewer.size());
}

TEST(VisibleExtents, AreFiveBytesInTheOrderOfTheirMembers) {
  VisibleSet set(std::vector<ObjectId>{ObjectId{3}, ObjectId{9}});
  set.set_extents({{1, 2, 3, 4, 5}, {250, 6, 7, 8, 9}});
  const EncodedExtents encoded = encode_extents(nullptr, set);
  EXPECT_EQ(encoded.cells, (std::vector<std::uint8_t>{1, 2, 3, 4, 5, 250, 6, 7, 8, 9}));
  EXPECT_EQ(encoded.ids, encode_keyframe(set));
}

TEST(VisibleExtents, AreAnywhereForASetThatSaysNothing) {
  std::mt19937_64 random(3);
  const VisibleSet silent(random_ids(100, k_object_count, random));
  const EncodedExtents encoded = encode_extents(nullptr, silent);
  EXPECT_TRUE(encoded.ids.empty() && encoded.cells.empty());
  EXPECT_TRUE(decoded(frame_of(nullptr, silent), nullptr).extents().empty());
}

TEST(VisibleExtents, AreAnywhereAfterABaseThatSaidWhere) {
  std::mt19937_64 random(9);
  const VisibleSet base = set_of(random_ids(100, k_object_count, random), random);
  VisibleSet anywhere(base.to_ids());
  anywhere.set_extents(std::vector<DirectionExtent>(anywhere.size(), k_seen_anywhere));
  const VisibleSet after = decoded(frame_of(&base, anywhere), &base);
  EXPECT_EQ(extents_of(after), extents_of(anywhere));
}

// An empty list says "as in the base": whoever wants to say nothing has to name every object.
TEST(VisibleExtents, OfASetThatSaysNothingAfterABaseThatSaidWhereAreAnywhere) {
  std::mt19937_64 random(10);
  const VisibleSet base = set_of(random_ids(100, k_object_count, random), random);
  const VisibleSet silent(base.to_ids());
  const VisibleSet after = decoded(frame_of(&base, silent), &base);
  for (const DirectionExtent& extent : after.extents()) EXPECT_EQ(extent, k_seen_anywhere);
}

TEST(VisibleExtents, OfAKeyframeOweNothingToTheBase) {
  std::mt19937_64 random(4);
  const VisibleSet base = set_of(random_ids(100, k_object_count, random), random);
  VisibleSetFrame frame = frame_of(nullptr, base);
  frame.extents_of.clear();
  frame.extents.clear();
  EXPECT_TRUE(decoded(frame, &base).extents().empty());
}

TEST(VisibleExtents, OfSomeObjectsLeaveTheOthersAnywhere) {
  const VisibleSet base(std::vector<ObjectId>{ObjectId{1}, ObjectId{2}});
  const VisibleSet set(std::vector<ObjectId>{ObjectId{1}, ObjectId{2}, ObjectId{5}});
  VisibleSetFrame frame = frame_of(&base, set);
  VisibleSet named(std::vector<ObjectId>{ObjectId{2}});
  frame.extents_of = encode_keyframe(named);
  frame.extents = {10, 20, 30, 40, 50};
  const DirectionExtent given{10, 20, 30, 40, 50};
  EXPECT_EQ(extents_of(decoded(frame, &base)), (std::vector{k_seen_anywhere, given, k_seen_anywhere}));
}

TEST(VisibleExtents, UnitingForgetsThem) {
  std::mt19937_64 random(5);
  VisibleSet set = set_of(random_ids(100, k_object_count, random), random);
  set.unite(set_of(random_ids(100, k_object_count, random), random));
  EXPECT_TRUE(set.extents().empty());
}

class HostileExtents : public testing::Test {
 protected:
  std::mt19937_64 random_{6};
  const std::vector<ObjectId> ids_ = random_ids(50, k_object_count, random_);
  const VisibleSet set_ = set_of(ids_, random_);
  VisibleSetFrame frame_ = frame_of(nullptr, set_);
};

TEST_F(HostileExtents, RefusesNamesThatAreNoBitmap) {
  ASSERT_EQ(reason_of(frame_), "decoded");
  frame_.extents_of.assign(100, 0xFF);
  EXPECT_THAT(reason_of(frame_), HasSubstr("bitmap"));
  frame_.extents_of.clear();
  EXPECT_THAT(reason_of(frame_), HasSubstr("bitmap"));
}

TEST_F(HostileExtents, RefusesAnotherNumberOfBytes) {
  for (const int change : {-250, -5, -1, 1, 4, 5, 250}) {
    VisibleSetFrame frame = frame_;
    frame.extents.resize(static_cast<std::size_t>(250 + change));
    EXPECT_THAT(reason_of(frame), HasSubstr("not as many extents")) << change;
  }
}

TEST_F(HostileExtents, RefusesObjectsThatAreNotInTheSet) {
  std::vector<ObjectId> others = ids_;
  others.back() = ObjectId{index_of(others.back()) + 1};
  frame_.extents_of = encode_keyframe(VisibleSet(others));
  EXPECT_THAT(reason_of(frame_), HasSubstr("not in it"));
  // Nor those the scene does not have, nor one that just left.
  others.back() = ObjectId{0xFFFFFFFFu};
  frame_.extents_of = encode_keyframe(VisibleSet(others));
  EXPECT_THAT(reason_of(frame_), HasSubstr("not in it"));

  std::vector<ObjectId> fewer(ids_.begin() + 1, ids_.end());
  VisibleSetFrame delta = frame_of(&set_, VisibleSet(fewer));
  delta.extents_of = encode_keyframe(VisibleSet(std::vector<ObjectId>{ids_.front()}));
  delta.extents.assign(5, 0);
  EXPECT_THAT(reason_of(delta, &set_), HasSubstr("not in it"));
}

TEST_F(HostileExtents, RefusesADeltaWithoutItsBase) {
  const VisibleSetFrame delta = frame_of(&set_, set_of(ids_, random_));
  ASSERT_EQ(reason_of(delta, &set_), "decoded");
  EXPECT_THAT(reason_of(delta, nullptr), HasSubstr("base is not held"));
}

// Whatever is taken has an extent for every object, or none.
TEST_F(HostileExtents, SurvivesBytesNobodyWroteOnPurpose) {
  int taken = 0, refused = 0;
  for (int round = 0; round < 20'000; ++round) {
    VisibleSetFrame frame = frame_;
    std::vector<std::uint8_t>& bytes = round % 8 == 0 ? frame.extents : frame.extents_of;
    for (std::uint64_t left = 1 + random_() % 3; left > 0; --left)
      bytes[random_() % bytes.size()] ^= static_cast<std::uint8_t>(1u << random_() % 8);
    if (random_() % 8 == 0) bytes.resize(random_() % (2 * bytes.size()));
    const auto result = decode_visible_set(frame, nullptr, k_object_count);
    const auto* set = std::get_if<VisibleSet>(&result);
    (set != nullptr ? taken : refused) += 1;
    if (set != nullptr) {
      ASSERT_EQ(set->extents().size(), set->size());
    }
  }
  EXPECT_GT(taken, 100);
  EXPECT_GT(refused, 100);
}

TEST(SettledExtents, AlwaysHoldWhatWasSeen) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 200; ++round) {
    const std::vector<ObjectId> before = random_ids(100, 400, random);
    VisibleSet base = set_of(before, random);
    VisibleSet set = set_of(random_ids(100, 400, random), random);
    // Close to those of the base, or not.
    std::vector<DirectionExtent> given = extents_of(set);
    const std::vector<ObjectId> ids = set.to_ids();
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const auto at = std::lower_bound(before.begin(), before.end(), ids[i]);
      if (random() % 3 == 0 || at == before.end() || *at != ids[i]) continue;
      const DirectionExtent& old = base.extents()[static_cast<std::size_t>(at - before.begin())];
      const auto near = [&](std::uint8_t value) {
        return static_cast<std::uint8_t>(value + random() % 7 - 3);
      };
      given[i] = {near(old.azimuth_first), near(old.azimuth_last), near(old.elevation_first),
                  near(old.elevation_last), near(old.distance)};
      if (given[i].elevation_first > given[i].elevation_last)
        std::swap(given[i].elevation_first, given[i].elevation_last);
    }
    set.set_extents(given);
    for (const VisibleSet* held : std::initializer_list<const VisibleSet*>{&base, nullptr}) {
      VisibleSet settled = set;
      settle_extents(held, settled);
      ASSERT_EQ(settled, set);
      ASSERT_EQ(settled.extents().size(), ids.size());
      for (std::size_t i = 0; i < ids.size(); ++i) ASSERT_TRUE(holds(settled.extents()[i], given[i]));
    }
  }
}

TEST(SettledExtents, StayThoseOfTheBaseWhileTheseServe) {
  const DirectionExtent seen{100, 110, 120, 130, 90};
  VisibleSet base(std::vector<ObjectId>{ObjectId{4}});
  base.set_extents({seen});
  settle_extents(nullptr, base);
  const DirectionExtent first = base.extents()[0];

  const auto settled_with = [&](const DirectionExtent& extent) {
    VisibleSet next(std::vector<ObjectId>{ObjectId{4}});
    next.set_extents({extent});
    settle_extents(&base, next);
    return next.extents()[0];
  };
  EXPECT_EQ(settled_with(seen), first);
  EXPECT_EQ(settled_with({101, 111, 119, 130, 88}), first);   // a cell to the side, a little nearer
  EXPECT_NE(settled_with({103, 113, 120, 130, 90}), first);   // three cells: out of it
  EXPECT_NE(settled_with({105, 106, 125, 126, 90}), first);   // within, but far smaller
  EXPECT_NE(settled_with({100, 110, 120, 130, 60}), first);   // nearer
  EXPECT_NE(settled_with({100, 110, 120, 130, 120}), first);  // far away now
}

TEST(SettledExtents, OfASlowTurnAreSeldomSent) {
  VisibleSet base(std::vector<ObjectId>{ObjectId{4}});
  int sent = 0;
  for (int frame = 0; frame < 64; ++frame) {
    VisibleSet next(std::vector<ObjectId>{ObjectId{4}});
    // A cell every eight frames, over the wrap.
    const auto first = static_cast<std::uint8_t>(252 + frame / 8);
    next.set_extents({{first, static_cast<std::uint8_t>(first + 4), 100, 110, 90}});
    settle_extents(&base, next);
    sent += encode_extents(&base, next).cells.empty() ? 0 : 1;
    base = next;
  }
  EXPECT_LE(sent, 5);
  EXPECT_GE(sent, 2);
}

TEST(SettledExtents, LeaveASetThatSaysNothingAlone) {
  std::mt19937_64 random(8);
  const std::vector<ObjectId> ids = random_ids(100, 400, random);
  const VisibleSet base = set_of(ids, random);
  VisibleSet silent(ids);
  settle_extents(&base, silent);
  EXPECT_TRUE(silent.extents().empty());
}

}  // namespace
}  // namespace sightline
