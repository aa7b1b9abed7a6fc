#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "control_view/clock.hpp"
#include "control_view/sent_sets.hpp"
#include "control_view/served_scene.hpp"
#include "control_view/visibility_pipeline.hpp"
#include "protocol/messages.hpp"

namespace sightline {

/// A request that waits for its turn.
struct PendingRequest {
  ViewRequest request;
  double received_s = 0.0;
  std::unique_ptr<const SceneEdits> edits{};  ///< those it was asked with, where they have changed since
};

/// One of the views that a session looks through: its requests, its filter and the sets it was sent.
class SessionView {
 public:
  SessionView(std::uint8_t view, const PipelineOptions& options, Clock clock);

  /// Takes a request in, in place of one that still waits: a reset of the filter passes on from that. One
  /// that is older than the newest heard of changes nothing. Returns whether a request was superseded.
  bool accept(ViewRequest request, double now_s);
  /// Whether the request would be taken in, so that its moves count.
  [[nodiscard]] bool is_news(const ViewRequest& request) const noexcept {
    return request.request_seq >= newest_request_seq_;
  }
  /// What the next answer must not average with: an object jumped, came or went.
  void reset_filter() noexcept { reset_due_ = true; }

  /// Before another view's request changes the session's edits: a request that waits is answered with those
  /// it was asked with. Its client reckons with that, view by view.
  void keep_edits(const SceneEdits& edits);

  [[nodiscard]] bool has_pending() const noexcept { return pending_.has_value(); }
  /// Since when the pending request waits, in its present form or an older one's. Requires has_pending().
  [[nodiscard]] double waits_since_s() const noexcept { return waits_since_s_; }

  /// Answers the pending request. Requires has_pending(), and edits.view to be this view. The frame's
  /// session_id is the caller's to fill.
  [[nodiscard]] VisibleSetFrame answer(ServedScene& scene, const SceneEdits& edits, double now_s);
  void note_encode_time(double encode_s) noexcept { last_encode_s_ = encode_s; }
  /// Why an object is in the newest set, or is not. Requires an id of the scene.
  [[nodiscard]] WhyAnswer why(const Why& question, ServedScene& scene, const SceneEdits& edits);

  [[nodiscard]] const VisibilityPipeline& pipeline() const noexcept { return pipeline_; }

 private:
  [[nodiscard]] const SceneEdits& edits_for(ViewKind kind, const ServedScene& scene, const SceneEdits& edits);

  std::uint8_t view_;
  PipelineOptions options_;
  Clock clock_;
  ImageSize size_;  ///< of the pipeline's control image
  VisibilityPipeline pipeline_;
  SentSets sent_;
  ViewKind kind_ = ViewKind::image;
  std::vector<BoxedObject> boxed_;               ///< of the last request answered
  SceneEdits shadow_edits_;                      ///< the session's, without what casts no shadow
  std::optional<std::uint64_t> shadow_version_;  ///< of the session's edits that these are made from
  std::optional<PendingRequest> pending_;
  double waits_since_s_ = 0.0;
  bool reset_due_ = false;
  std::uint64_t newest_request_seq_ = 0;
  double last_encode_s_ = 0.0;
};

}  // namespace sightline
