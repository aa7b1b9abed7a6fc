#include "main_view/app/virtual_daemon.hpp"

#include <gtest/gtest.h>

namespace sightline {
namespace {

/// Steps of 1/60 s; which frame's request each answer answers, and the frame at which it arrives.
struct Arrival {
  std::uint64_t request_seq;
  int frame;
  bool operator==(const Arrival&) const = default;
};

std::vector<Arrival> replay(std::optional<double> rate_hz, double latency_s, int frames) {
  const auto echo = [](const ViewRequest& request) {
    Answer answer;
    answer.request = request;
    return answer;
  };
  VirtualDaemon daemon(echo, rate_hz, latency_s);
  std::vector<Arrival> arrivals;
  const auto take = [&](int frame) {
    for (const auto& delivery : daemon.deliver(frame / 60.0)) {
      arrivals.push_back({delivery.answer.request.request_seq, frame});
      EXPECT_GE(delivery.received_s, delivery.issued_s + latency_s - 1e-9);
    }
  };
  for (int frame = 0; frame < frames; ++frame) {
    take(frame);
    ViewRequest request;
    request.request_seq = static_cast<std::uint64_t>(frame);
    daemon.issue(request, frame / 60.0);
    take(frame);
  }
  return arrivals;
}

TEST(VirtualDaemon, AnswersInTheSameFrameWithoutLatency) {
  EXPECT_EQ(replay({}, 0.0, 3), (std::vector<Arrival>{{0, 0}, {1, 1}, {2, 2}}));
}

TEST(VirtualDaemon, AnswersEverySecondFrameAtHalfTheRate) {
  // 50 ms are three frames.
  EXPECT_EQ(replay(30.0, 0.05, 8), (std::vector<Arrival>{{0, 3}, {2, 5}, {4, 7}}));
}

TEST(VirtualDaemon, StartsTheNewestRequestWhenASlotFallsBetweenFrames) {
  // Slots every 1/40 s: at 0, 1.5, 3, 4.5 frames. The one at 1.5 takes frame 1's request.
  EXPECT_EQ(replay(40.0, 0.0, 6), (std::vector<Arrival>{{0, 0}, {1, 2}, {3, 3}, {4, 5}}));
}

TEST(VirtualDaemon, DoesNotDriftOverManyFrames) {
  EXPECT_EQ(replay(30.0, 0.0, 36'000).size(), 18'000u);
}

}  // namespace
}  // namespace sightline
