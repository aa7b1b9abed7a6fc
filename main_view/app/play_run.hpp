#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "main_view/app/common_options.hpp"
#include "protocol/messages.hpp"

namespace sightline {

/// One measured frame.
struct FrameTiming {
  std::uint32_t frame = 0;
  double frame_s = 0.0;  ///< culling, drawing and waiting for the picture
  std::uint32_t drawn_objects = 0;
  std::uint64_t drawn_triangles = 0;
  bool fallback = false;
};

/// What one culling mode did over the path.
struct PlayRun {
  CullingMode mode = CullingMode::none;
  std::vector<FrameTiming> frames;
};

/// What the service did meanwhile.
struct ServiceTiming {
  std::vector<double> round_trip_s;     ///< request sent to answer decoded
  std::vector<double> link_overhead_s;  ///< of that, neither waiting in the daemon nor its engine's
  std::vector<StageTimes> stages;
  double open_s = 0.0;  ///< wall time that service frames ran for
  std::uint64_t bytes_sent = 0, bytes_received = 0, bad_frames = 0, sessions_lost = 0;
};

}  // namespace sightline
