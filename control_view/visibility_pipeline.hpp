#pragma once

#include <cstdint>
#include <vector>

#include "control_view/clock.hpp"
#include "control_view/engine.hpp"
#include "control_view/low_pass_filter.hpp"
#include "control_view/object_standing.hpp"
#include "control_view/still_view_refiner.hpp"
#include "protocol/messages.hpp"
#include "protocol/visible_set.hpp"

namespace sightline {

struct PipelineOptions {
  ImageSize size{512, 384};         ///< of the control image, pixels per eye
  std::uint32_t filter_length = 8;  ///< answers, 1 is none
  double threshold_pixels = 0.0;
  bool refine = true;                     ///< look closer while the camera stands still
  std::optional<double> sample_px = 1.0;  ///< look for open objects too, see ViewDoubt
  /// Of the position error that a request states, how much its answer is to hold for: announced errors are
  /// far above the usual ones, and every pixel of parallax leaves more objects open.
  double region_share = 0.1;
  bool extents = true;  ///< say in which directions each object was seen
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

  /// Whether answers from before an object went away can keep out of the set what it hid: a mean above a
  /// threshold takes some answers to rise. Without a threshold one look is enough, and forgetting the others
  /// would only lose what they saw.
  [[nodiscard]] bool remembers_absence() const noexcept { return options_.threshold_pixels > 0.0; }

  /// Throws what the engine throws.
  [[nodiscard]] Look look(const ViewRequest& request, const SceneEdits& edits, VisibilityEngine& engine);

  /// The newest look at the whole view. Its eyes are valid until the next look.
  [[nodiscard]] LookedAt looked_at() const noexcept;
  /// Why an object is in the newest set; nothing about one that is not, but for too few pixels.
  [[nodiscard]] ObjectStanding standing_of(ObjectId id) const;

 private:
  void count_whole_view(const ViewRequest& request, VisibilityEngine& engine, Look& look);
  void count_tile(const ViewRequest& request, VisibilityEngine& engine, Look& look);
  void count(const ViewQuery& query, VisibilityEngine& engine, Look& look);
  [[nodiscard]] VisibleSet visible_now(bool guard_band);
  /// Takes note of the objects on the move; whether some are that were at rest before.
  bool begin_boxed(const ViewRequest& request);
  [[nodiscard]] double near_reach_of(const ViewRequest& request);
  void add_open(VisibleSet& visible) const;
  void say_where(const ViewRequest& request, VisibleSet& visible) const;

  PipelineOptions options_;
  Clock clock_;
  LowPassFilter filter_;
  StillViewRefiner refiner_;
  std::vector<Eye> widened_eyes_;  ///< of the last whole look, as is the next
  ImageSize looked_size_;
  std::uint64_t answered_seq_ = 0;  ///< newest request answered, 0: none yet
  bool added_open_ = false;         ///< the newest set holds counts_.open
  bool guard_band_ = false;         ///< the newest set holds the last whole view
  std::vector<ObjectId> boxed_;     ///< of the last request
  PixelCounts counts_;
  std::optional<glm::dvec3> last_eye_m_;  ///< of the last request
  std::vector<ObjectId> scratch_;
};

/// The error a request states, made safe to widen by: not finite or above pi becomes pi, negative 0.
[[nodiscard]] double rotation_error_of(const ViewRequest& request) noexcept;

}  // namespace sightline
