#include <gtest/gtest.h>

#include "main_view/client/horizon_estimator.hpp"
#include "main_view/client/visible_set_timeline.hpp"

namespace sightline {
namespace {

ViewRequest request_for(double time_s, std::uint64_t seq) {
  ViewRequest request;
  request.for_time_s = time_s;
  request.request_seq = seq;
  return request;
}

VisibleSet set_of(std::uint32_t id) {
  const ObjectId ids[] = {ObjectId{id}};
  return VisibleSet(ids);
}

TEST(VisibleSetTimeline, FindsTheNearestSetOnEitherSideOfNow) {
  VisibleSetTimeline timeline;
  for (const int i : {3, 1, 4, 2}) timeline.file(request_for(i, static_cast<std::uint64_t>(i)), set_of(1));
  EXPECT_EQ(timeline.last_at_or_before(2.5)->request.request_seq, 2u);
  EXPECT_EQ(timeline.next_after(2.5)->request.request_seq, 3u);
  EXPECT_EQ(timeline.last_at_or_before(3.0)->request.request_seq, 3u);
  EXPECT_EQ(timeline.next_after(3.0)->request.request_seq, 4u);
  EXPECT_EQ(timeline.last_at_or_before(0.5), nullptr);
  EXPECT_EQ(timeline.next_after(4.0), nullptr);
}

TEST(VisibleSetTimeline, IgnoresAnAnswerOlderThanTheOneItHoldsForTheSameTime) {
  VisibleSetTimeline timeline;
  timeline.file(request_for(1.0, 7), set_of(7));
  timeline.file(request_for(1.0, 6), set_of(6));
  EXPECT_TRUE(timeline.last_at_or_before(1.0)->set.contains(ObjectId{7}));
  timeline.file(request_for(1.0, 8), set_of(8));
  EXPECT_TRUE(timeline.last_at_or_before(1.0)->set.contains(ObjectId{8}));
  EXPECT_EQ(timeline.size(), 1u);
}

TEST(VisibleSetTimeline, HoldsNoMoreThanItsCapacity) {
  VisibleSetTimeline timeline(4);
  for (int i = 0; i < 100; ++i) timeline.file(request_for(i, 1), set_of(1));
  EXPECT_EQ(timeline.size(), 4u);
  EXPECT_EQ(timeline.last_at_or_before(95.5), nullptr);
  timeline.drop_before(98.0);
  EXPECT_EQ(timeline.size(), 2u);
}

TEST(HorizonEstimator, BeginsWithTheStatedValue) {
  CullingOptions options;
  options.initial_horizon_s = 0.07;
  EXPECT_EQ(HorizonEstimator(options).horizon_s(), 0.07);
}

TEST(HorizonEstimator, IsExactlyZeroWithoutLatency) {
  HorizonEstimator horizon{CullingOptions{}};
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(horizon.horizon_s(), 0.0);
    horizon.observe(i / 60.0, i / 60.0);
  }
}

TEST(HorizonEstimator, NeverExceedsItsLimit) {
  HorizonEstimator horizon{CullingOptions{}};
  for (int i = 0; i < 10; ++i) horizon.observe(i, i + 5.0);
  EXPECT_EQ(horizon.horizon_s(), CullingOptions{}.max_horizon_s);
}

/// The audit's virtual clock: frames at 60 Hz, each with a request; the daemon starts at most 30 a second,
/// always on the newest, and answers `latency_s` later.
struct Bracketing {
  int frames = 0;
  int with_next = 0;
  double horizon_s = 0.0;
};

Bracketing simulate(double latency_s) {
  HorizonEstimator horizon{CullingOptions{}};
  VisibleSetTimeline timeline;
  struct OnTheWay {
    double issued_s, for_s, arrives_s;
  };
  std::vector<OnTheWay> under_way;
  double daemon_free_s = 0.0;
  Bracketing result;
  for (int i = 0; i < 300; ++i) {
    const double now_s = i / 60.0;
    while (!under_way.empty() && under_way.front().arrives_s <= now_s + 1e-9) {
      horizon.observe(under_way.front().issued_s, now_s);
      timeline.file(request_for(under_way.front().for_s, 1), set_of(1));
      under_way.erase(under_way.begin());
    }
    if (now_s >= daemon_free_s - 1e-9) {
      under_way.push_back({now_s, now_s + horizon.horizon_s(), now_s + latency_s});
      daemon_free_s = now_s + 1.0 / 30.0;
    }
    if (now_s < 0.5 + latency_s) continue;
    ++result.frames;
    result.with_next += timeline.next_after(now_s) != nullptr && timeline.last_at_or_before(now_s) != nullptr;
  }
  result.horizon_s = horizon.horizon_s();
  return result;
}

TEST(HorizonEstimator, BracketsNowFromHalfASecondOn) {
  for (const double latency_s : {0.02, 0.05, 0.1, 0.2}) {
    const Bracketing result = simulate(latency_s);
    EXPECT_GE(result.with_next, result.frames * 99 / 100) << latency_s;
    EXPECT_GT(result.horizon_s, latency_s + 1.0 / 30.0);
    EXPECT_LT(result.horizon_s, latency_s + 2.5 / 30.0) << latency_s;
  }
}

TEST(VisibleSetTimeline, KnowsTheOldestRequestThatMayStillServe) {
  VisibleSetTimeline timeline;
  EXPECT_FALSE(timeline.lowest_request_seq(0.0));
  ViewRequest request;
  for (const auto& [seq, time_s] : {std::pair<std::uint64_t, double>{4, 1.0}, {2, 3.0}, {3, 2.0}}) {
    request.request_seq = seq;
    request.for_time_s = time_s;
    timeline.file(request, VisibleSet());
  }
  EXPECT_EQ(timeline.lowest_request_seq(0.0), 2u);
  EXPECT_EQ(timeline.lowest_request_seq(3.0), 2u);
  EXPECT_FALSE(timeline.lowest_request_seq(3.5));
}

}  // namespace
}  // namespace sightline
