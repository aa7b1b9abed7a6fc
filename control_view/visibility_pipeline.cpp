#include "control_view/visibility_pipeline.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "control_view/threshold.hpp"

namespace sightline {

double rotation_error_of(const ViewRequest& request) noexcept {
  const double error = request.rotation_error_rad;
  return std::isfinite(error) ? std::clamp(error, 0.0, std::numbers::pi) : std::numbers::pi;
}

VisibilityPipeline::VisibilityPipeline(const PipelineOptions& options, Clock clock)
    : options_(options), clock_(std::move(clock)), filter_(options.filter_length), refiner_(options.size) {}

Look VisibilityPipeline::look(const ViewRequest& request, const SceneEdits& edits, VisibilityEngine& engine) {
  Look look;
  if (request.reset_filter) {
    filter_.reset();
    refiner_.reset();
  }
  engine.apply(edits);

  // What the sweep of the last view found would pop away with the first coarse look at this one.
  refiner_.findings(counts_);
  const bool another_view = refiner_.begin(request, edits.version);
  if (another_view && !counts_.ids.empty()) filter_.add(counts_);

  const double error_rad = rotation_error_of(request);
  const auto next = options_.refine ? refiner_.next_look(error_rad) : StillViewRefiner::Look::whole_view;
  if (next == StillViewRefiner::Look::whole_view) count_whole_view(request, engine, look);
  if (next == StillViewRefiner::Look::tile) count_tile(request, engine, look);

  const double filter_began_s = clock_();
  if (next == StillViewRefiner::Look::whole_view) {
    filter_.add(counts_);
    if (options_.refine) refiner_.add_whole_view(counts_, error_rad);
  }
  if (next == StillViewRefiner::Look::tile) refiner_.add_tile(counts_);
  look.visible = visible_now(error_rad > 0.0);
  look.times.filter_s = clock_() - filter_began_s;
  return look;
}

void VisibilityPipeline::count_whole_view(const ViewRequest& request, VisibilityEngine& engine, Look& look) {
  const double error_rad = rotation_error_of(request);
  widened_eyes_.assign(request.eyes.begin(), request.eyes.end());
  if (error_rad > 0.0) {
    for (Eye& eye : widened_eyes_) eye.clip_from_camera = widened(eye.clip_from_camera, error_rad);
  }
  count({widened_eyes_, options_.size, {}}, engine, look);
}

void VisibilityPipeline::count_tile(const ViewRequest& request, VisibilityEngine& engine, Look& look) {
  const StillViewRefiner::Tile tile = refiner_.tile();
  count({request.eyes, tile.size, tile.window}, engine, look);
}

void VisibilityPipeline::count(const ViewQuery& query, VisibilityEngine& engine, Look& look) {
  const EngineStats stats = engine.count(query, counts_);
  look.times.cull_s = stats.cull_s;
  look.times.draw_s = stats.draw_s;
  look.times.count_s = stats.count_s;
  look.drawn_objects = stats.drawn_objects;
}

VisibleSet VisibilityPipeline::visible_now(bool guard_band) {
  const double threshold = options_.threshold_pixels;
  if (!refiner_.complete()) {
    VisibleSet visible = visible_above(filter_.means(), threshold, scratch_);
    visible.unite(VisibleSet(refiner_.seen_in_tiles().ids));
    return visible;
  }
  VisibleSet visible = visible_above(refiner_.seen_in_tiles(), threshold, scratch_);
  if (guard_band) visible.unite(visible_above(refiner_.seen_in_whole_view(), threshold, scratch_));
  return visible;
}

}  // namespace sightline
