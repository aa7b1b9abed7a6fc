#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "control_view/apply_moves.hpp"
#include "control_view/rate_limit.hpp"
#include "control_view/sent_sets.hpp"

namespace sightline {
namespace {

ObjectMove move_of(std::uint32_t id, double x) {
  ObjectMove move{ObjectId{id}, glm::dmat4x3(1.0)};
  move.world_from_object[3][0] = x;
  return move;
}

VisibleSet set_of(std::uint32_t id) {
  const ObjectId ids[] = {ObjectId{id}};
  return VisibleSet(ids);
}

TEST(MovedObjects, AreWhatAMapOfTheLastMovesHolds) {
  std::mt19937 random(7);
  SceneEdits edits;
  std::map<std::uint32_t, double> expected;
  for (int request = 0; request < 300; ++request) {
    std::vector<ObjectMove> moves;
    const auto before = expected;
    for (std::uint32_t i = random() % 8; i-- > 0;) {
      moves.push_back(move_of(random() % 40, static_cast<double>(random() % 3)));
      expected[index_of(moves.back().id)] = moves.back().world_from_object[3][0];
    }
    const std::uint64_t version = edits.version;
    apply_moves(edits, moves);
    ASSERT_EQ(edits.version != version, expected != before);
    std::map<std::uint32_t, double> held;
    for (const ObjectMove& move : edits.moves) held[index_of(move.id)] = move.world_from_object[3][0];
    ASSERT_EQ(held, expected);
    ASSERT_EQ(edits.moves.size(), expected.size());
    ASSERT_TRUE(std::is_sorted(edits.moves.begin(), edits.moves.end(),
                               [](const auto& a, const auto& b) { return a.id < b.id; }));
  }
}

TEST(MovedObjects, KeepTheirVersionWhenAMoveIsRepeated) {
  SceneEdits edits;
  apply_moves(edits, {move_of(3, 1.0)});
  EXPECT_EQ(edits.version, 1u);
  apply_moves(edits, {move_of(3, 1.0)});
  EXPECT_EQ(edits.version, 1u);
}

TEST(AbsentObjects, AreWhatASetOfTheLastChangesHolds) {
  std::mt19937 random(8);
  SceneEdits edits;
  std::set<ObjectId> expected;
  for (int request = 0; request < 300; ++request) {
    std::map<ObjectId, bool> changes;
    for (std::uint32_t i = random() % 8; i-- > 0;)
      changes[ObjectId{static_cast<std::uint32_t>(random() % 40)}] = random() % 2 == 0;
    std::vector<ObjectPresence> presence;
    const auto before = expected;
    for (const auto& [id, present] : changes) {
      presence.push_back({id, present});
      if (present) expected.erase(id);
      if (!present) expected.insert(id);
    }
    const std::uint64_t version = edits.version;
    ASSERT_EQ(apply_presence(edits, presence), expected != before);
    ASSERT_EQ(edits.version != version, expected != before);
    ASSERT_EQ(edits.hidden, std::vector<ObjectId>(expected.begin(), expected.end()));
  }
}

TEST(SentSets, FindWhatWasAddedLatelyAndNothingElse) {
  SentSets sets;
  const auto last = static_cast<std::uint32_t>(SentSets::k_capacity + 10);
  for (std::uint32_t i = 1; i <= last; ++i) EXPECT_EQ(sets.add(set_of(i)), i);
  EXPECT_EQ(sets.size(), SentSets::k_capacity);
  EXPECT_EQ(sets.find(0), nullptr);
  EXPECT_EQ(sets.find(10), nullptr);
  EXPECT_EQ(sets.find(last + 1), nullptr);
  EXPECT_EQ(sets.find(~0ull), nullptr);
  for (std::uint32_t i = 11; i <= last; ++i) {
    ASSERT_NE(sets.find(i), nullptr);
    EXPECT_EQ(*sets.find(i), set_of(i));
  }
}

TEST(SentSets, ForgetWhatIsOlderThanTheAcknowledged) {
  SentSets sets;
  for (std::uint32_t i = 1; i <= 5; ++i) (void)sets.add(set_of(i));
  sets.acknowledge(4);
  EXPECT_EQ(sets.find(3), nullptr);
  EXPECT_EQ(*sets.find(4), set_of(4));
  sets.acknowledge(2);
  sets.acknowledge(99);
  EXPECT_EQ(*sets.find(5), set_of(5));
  EXPECT_EQ(sets.add(set_of(6)), 6u);
}

TEST(RateLimit, LetsOneThingHappenPerIntervalAndKey) {
  RateLimit limit(1.0);
  EXPECT_TRUE(limit.take("a", 0.0));
  EXPECT_FALSE(limit.take("a", 0.9));
  EXPECT_TRUE(limit.take("b", 0.9));
  EXPECT_TRUE(limit.take("a", 1.1));
}

TEST(RateLimit, DoesNotGrowWithEverNewKeys) {
  RateLimit limit(1.0);
  std::size_t taken = 0;
  for (int i = 0; i < 5000; ++i) taken += limit.take(std::to_string(i), 0.0) ? 1 : 0;
  EXPECT_EQ(taken, RateLimit::k_max_keys);
  EXPECT_TRUE(limit.take("later", 2.0));
}

}  // namespace
}  // namespace sightline
