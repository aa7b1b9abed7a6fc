#pragma once

#include <optional>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "main_view/app/frame_judge.hpp"

namespace sightline {

/// One audited frame.
struct FrameRecord {
  double time_s = 0.0;  ///< into the path
  FrameVerdict verdict;
  bool fallback = false;                          ///< drawn with view-frustum culling alone
  std::optional<double> last_age_s, next_lead_s;  ///< of the sets it was drawn with
  std::uint32_t drawn_changes = 0;  ///< objects drawn here or in the frame before, but not in both
  std::uint32_t true_changes = 0;   ///< the same of the truly visible ones; both 0 in the first frame
};

/// The report's `quality`: fields as docs/architecture.md defines them.
[[nodiscard]] nlohmann::ordered_json quality_of(const std::vector<FrameRecord>& frames,
                                                std::uint32_t object_count, std::uint64_t triangle_count,
                                                std::uint32_t depth_frustum_max,
                                                std::uint32_t depth_drawn_max);

}  // namespace sightline
