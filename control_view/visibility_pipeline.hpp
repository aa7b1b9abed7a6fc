#pragma once

#include <cstdint>
#include <vector>

#include "control_view/clock.hpp"
#include "control_view/engine.hpp"
#include "control_view/low_pass_filter.hpp"
#include "control_view/still_view_refiner.hpp"
#include "protocol/messages.hpp"
#include "protocol/visible_set.hpp"

namespace sightline {

struct PipelineOptions {
  ImageSize size{512, 384};         ///< of the control image, pixels per eye
  std::uint32_t filter_length = 8;  ///< answers, 1 is none
  double threshold_pixels = 0.0;
  bool refine = true;  ///< look closer while the camera stands still
};

/// What one session's request is answered with.
struct Look {
  VisibleSet visible;
  StageTimes times;  ///< cull, draw, count and filter
  std::uint32_t drawn_objects = 0;
};

/// From a view to a visible set: widen -> count -> filter -> threshold. One a session, since the filter
/// remembers.
///
/// Direction of error: aggressive as a sampled item buffer is, for the field widened by the request's
/// rotation_error_rad; the filter and the still-view sweep move it towards exact. Once the sweep of a still
/// camera is complete the set is exactly what the main image shows, plus, when rotation_error_rad > 0, what
/// the last whole view showed in the widened field (most of it outside the main image, where the client's own
/// frustum culls it).
class VisibilityPipeline {
 public:
  VisibilityPipeline(const PipelineOptions& options, Clock clock);

  /// Throws what the engine throws.
  [[nodiscard]] Look look(const ViewRequest& request, const SceneEdits& edits, VisibilityEngine& engine);

 private:
  void count_whole_view(const ViewRequest& request, VisibilityEngine& engine, Look& look);
  void count_tile(const ViewRequest& request, VisibilityEngine& engine, Look& look);
  void count(const ViewQuery& query, VisibilityEngine& engine, Look& look);
  [[nodiscard]] VisibleSet visible_now(bool guard_band);

  PipelineOptions options_;
  Clock clock_;
  LowPassFilter filter_;
  StillViewRefiner refiner_;
  std::vector<Eye> widened_eyes_;
  PixelCounts counts_;
  std::vector<ObjectId> scratch_;
};

/// The error a request states, made safe to widen by: not finite or above pi becomes pi, negative 0.
[[nodiscard]] double rotation_error_of(const ViewRequest& request) noexcept;

}  // namespace sightline
