#include <limits>

#include <gtest/gtest.h>

#include "main_view/client/object_ids.hpp"

namespace sightline {
namespace {

RequestNumbers all(std::uint64_t number) {
  RequestNumbers numbers;
  numbers.fill(number);
  return numbers;
}

TEST(ObjectIds, GivesOutEachSpareIdOnce) {
  ObjectIds ids(10, 2);
  EXPECT_EQ(ids.free_count(), 2u);
  EXPECT_EQ(ids.take(), ObjectId{10});
  EXPECT_EQ(ids.take(), ObjectId{11});
  EXPECT_FALSE(ids.take());
}

TEST(ObjectIds, ReusesAnIdOnlyWhenNoViewCanNameItAnyMore) {
  ObjectIds ids(10, 1);
  const ObjectId id = *ids.take();
  RequestNumbers next = all(1);
  next[0] = 20;
  next[3] = 7;
  ids.retire(id, next);
  ids.release(all(6));
  EXPECT_FALSE(ids.take());
  RequestNumbers oldest = all(std::numeric_limits<std::uint64_t>::max());
  oldest[0] = 19;  // a set from before is still at hand
  ids.release(oldest);
  EXPECT_FALSE(ids.take());
  oldest[0] = 20;
  oldest[3] = 6;
  ids.release(oldest);
  EXPECT_FALSE(ids.take());
  oldest[3] = 7;
  ids.release(oldest);
  EXPECT_EQ(ids.take(), id);
  EXPECT_EQ(ids.quarantined_count(), 0u);
}

}  // namespace
}  // namespace sightline
