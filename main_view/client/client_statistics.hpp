#pragma once

#include <cstdint>

#include "protocol/messages.hpp"

namespace sightline {

/// What a client has measured since it was made; times in seconds of the application's clock, smoothed where
/// they say so.
struct ClientStatistics {
  double round_trip_s = 0.0;   ///< request sent to answer filed; smoothed
  double answers_per_s = 0.0;  ///< of all views; smoothed
  double horizon_s = 0.0;      ///< how far ahead view requests are asked, the largest of the views
  std::uint64_t frames = 0;
  std::uint64_t fallback_frames = 0;  ///< with at least one view that drew all in its frustum
  std::uint64_t requests = 0;
  std::uint64_t answers = 0;
  std::uint64_t bytes_sent = 0;  ///< uploads included
  std::uint64_t bytes_received = 0;
  std::uint64_t sessions_lost = 0;
  std::uint64_t bad_frames = 0;            ///< of the daemon, dropped
  std::uint64_t listed_objects = 0;        ///< in the newest frame, all views
  std::uint64_t visible_objects = 0;       ///< in the sets it was decided by, all views
  std::uint64_t moved_objects = 0;         ///< told in the newest frame
  double begin_frame_s = 0.0;              ///< the newest frame's begin_frame, real time, without waiting
  StageTimes daemon_times;                 ///< of the newest answer
  std::uint32_t daemon_drawn_objects = 0;  ///< likewise
};

}  // namespace sightline
