#include "control_view/visibility_pipeline.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>

#include "control_view/threshold.hpp"

namespace sightline {

double rotation_error_of(const ViewRequest& request) noexcept {
  const double error = request.rotation_error_rad;
  return std::isfinite(error) ? std::clamp(error, 0.0, std::numbers::pi) : std::numbers::pi;
}

namespace {

/// Where the first eye is, world frame.
glm::dvec3 eye_m_of(const ViewRequest& request) noexcept {
  return request.eyes.empty() ? glm::dvec3(0.0) : position_of(request.eyes.front());
}

// A longer way between two requests is a jump.
constexpr double k_longest_step_m = 1.0;
// A field twice as wide each way costs four times the pixels: beyond that they become larger instead.
constexpr double k_widest = 2.0;
// Steps in which an image grows, so that its size does not change with every request.
constexpr double k_steps = 8.0;

/// How much wider a view has to be looked at for samples all round its edge: the outermost ones lie half a
/// pixel inside, and those of a finer image farther out.
double pixel_rad(const glm::dmat4& clip_from_camera, ImageSize size) {
  const double half_field_rad = std::atan(1.0 / std::abs(clip_from_camera[1][1]));
  return 2.0 * half_field_rad / std::max(size.height, 1u);
}

/// Of an upright perspective, along the view's axis.
double near_plane_m(const glm::dmat4& clip_from_camera) noexcept {
  return clip_from_camera[3][2] / (clip_from_camera[2][2] - 1.0);
}

/// As many pixels a degree as an image of `size` has of the eyes' own fields, for the widened ones.
ImageSize widened_size(ImageSize size, std::span<const Eye> eyes, std::span<const Eye> widened_eyes) {
  double across = 1.0, up = 1.0;
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    across = std::max(across, eyes[i].clip_from_camera[0][0] / widened_eyes[i].clip_from_camera[0][0]);
    up = std::max(up, eyes[i].clip_from_camera[1][1] / widened_eyes[i].clip_from_camera[1][1]);
  }
  const auto grown = [](std::uint32_t side, double by) {
    const double steps = std::ceil(k_steps * std::min(by, k_widest));
    return std::min(k_max_image_side, static_cast<std::uint32_t>(std::ceil(side * steps / k_steps)));
  };
  return {grown(size.width, across), grown(size.height, up)};
}

}  // namespace

double VisibilityPipeline::near_reach_of(const ViewRequest& request) {
  double reach_m = 0.0;
  for (const Eye& eye : request.eyes) reach_m = std::max(reach_m, near_reach_m(eye.clip_from_camera));
  // The client is on its way between the eyes of two requests, or as far off as it says.
  const glm::dvec3 eye_m = eye_m_of(request);
  const double step_m = last_eye_m_ ? std::min(glm::length(eye_m - *last_eye_m_), k_longest_step_m) : 0.0;
  last_eye_m_ = eye_m;
  return reach_m + std::max(step_m, options_.region_share * request.position_error_m);
}

VisibilityPipeline::VisibilityPipeline(const PipelineOptions& options, Clock clock)
    : options_(options), clock_(std::move(clock)), filter_(options.filter_length), refiner_(options.size) {}

Look VisibilityPipeline::look(const ViewRequest& request, const SceneEdits& edits, VisibilityEngine& engine) {
  Look look;
  if (request.reset_filter) {
    filter_.reset();
    refiner_.reset();
  }
  if (begin_boxed(request) && remembers_absence()) filter_.reset();
  engine.apply(edits);

  // What the sweep of the last view found would pop away with the first coarse look at this one.
  refiner_.findings(counts_);
  // What moves is looked at anew each time; a sweep would show it where it was.
  if (!boxed_.empty()) refiner_.reset();
  const bool another_view = refiner_.begin(request, edits.version);
  if (another_view && !counts_.ids.empty()) filter_.add(counts_);

  const double error_rad = rotation_error_of(request);
  const auto next =
      options_.refine && boxed_.empty() ? refiner_.next_look(error_rad) : StillViewRefiner::Look::whole_view;
  if (next == StillViewRefiner::Look::whole_view) count_whole_view(request, engine, look);
  answered_seq_ = request.request_seq;
  if (next == StillViewRefiner::Look::tile) count_tile(request, engine, look);

  const double filter_began_s = clock_();
  if (next == StillViewRefiner::Look::whole_view) {
    filter_.add(counts_, eye_m_of(request));
    if (options_.refine) refiner_.add_whole_view(counts_, error_rad);
  }
  if (next == StillViewRefiner::Look::tile) refiner_.add_tile(counts_);
  guard_band_ = error_rad > 0.0;
  look.visible = visible_now(guard_band_);
  // A boxed object counts one pixel however large it is: no threshold is for it.
  if (!boxed_.empty()) {
    scratch_.clear();
    std::set_intersection(counts_.ids.begin(), counts_.ids.end(), boxed_.begin(), boxed_.end(),
                          std::back_inserter(scratch_));
    look.visible.unite(VisibleSet(scratch_));
  }
  if (options_.extents) say_where(request, look.visible);
  added_open_ = next == StillViewRefiner::Look::whole_view && !counts_.open.ids.empty();
  if (added_open_) add_open(look.visible);
  look.times.filter_s = clock_() - filter_began_s;
  return look;
}

void VisibilityPipeline::count_whole_view(const ViewRequest& request, VisibilityEngine& engine, Look& look) {
  const double error_rad = rotation_error_of(request);
  const bool is_the_main_image =
      error_rad == 0.0 && request.position_error_m == 0.0 && options_.size == request.main_size;
  const bool in_doubt = options_.sample_px && !is_the_main_image;
  widened_eyes_.assign(request.eyes.begin(), request.eyes.end());
  for (Eye& eye : widened_eyes_) {
    const glm::dmat4 projection = eye.clip_from_camera;
    if (error_rad > 0.0) {
      eye.clip_from_camera = widened(projection, error_rad);
      // What the client's near plane may cut away hides nothing. The client draws whatever comes that near.
      if (options_.sample_px) move_near_plane(eye.clip_from_camera, near_reach_m(projection));
    } else if (in_doubt) {
      eye.clip_from_camera = widened(projection, pixel_rad(projection, options_.size));
      // The view is known: nothing nearer than its own near plane hides anything.
      if (is_upright_perspective(projection)) move_near_plane(eye.clip_from_camera, near_plane_m(projection));
    }
  }
  ViewQuery query;
  query.eyes = widened_eyes_;
  query.size = options_.extents && error_rad > 0.0 ? widened_size(options_.size, request.eyes, widened_eyes_)
                                                   : options_.size;
  query.boxed = request.boxed;
  if (in_doubt) {
    query.doubt = {options_.region_share * request.position_error_m, *options_.sample_px,
                   error_rad > 0.0 ? near_reach_of(request) : 0.0};
  }
  looked_size_ = query.size;
  count(query, engine, look);
}

bool VisibilityPipeline::begin_boxed(const ViewRequest& request) {
  scratch_.clear();
  for (const BoxedObject& object : request.boxed) scratch_.push_back(object.id);
  const bool more = !std::includes(boxed_.begin(), boxed_.end(), scratch_.begin(), scratch_.end());
  boxed_.swap(scratch_);
  return more;
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

void VisibilityPipeline::add_open(VisibleSet& visible) const {
  const OpenObjects& open = counts_.open;
  const std::vector<ObjectId> seen = visible.to_ids();
  const std::span<const DirectionExtent> seen_extents = visible.extents();
  std::vector<ObjectId> ids;
  std::vector<DirectionExtent> extents;
  std::size_t s = 0, o = 0;
  while (s < seen.size() || o < open.ids.size()) {
    const bool from_seen = o == open.ids.size() || (s < seen.size() && seen[s] <= open.ids[o]);
    const bool from_open = s == seen.size() || (o < open.ids.size() && open.ids[o] <= seen[s]);
    ids.push_back(from_seen ? seen[s] : open.ids[o]);
    if (!seen_extents.empty() || seen.empty()) {
      extents.push_back(from_seen && from_open ? united(seen_extents[s], open.extents[o])
                        : from_seen            ? seen_extents[s]
                                               : open.extents[o]);
    }
    if (from_seen) ++s;
    if (from_open) ++o;
  }
  visible = VisibleSet(ids);
  visible.set_extents(std::move(extents));
}

void VisibilityPipeline::say_where(const ViewRequest& request, VisibleSet& visible) const {
  const std::vector<ObjectId> ids = visible.to_ids();
  std::vector<DirectionExtent> extents;
  filter_.extents_of(ids, eye_m_of(request), extents);
  // What the closer looks saw was counted without saying where.
  const auto tiles = refiner_.seen_in_tiles().ids;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const bool boxed = std::binary_search(boxed_.begin(), boxed_.end(), ids[i]);  // held anywhere in its box
    if (boxed || std::binary_search(tiles.begin(), tiles.end(), ids[i])) extents[i] = k_seen_anywhere;
  }
  visible.set_extents(std::move(extents));
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

LookedAt VisibilityPipeline::looked_at() const noexcept {
  return {answered_seq_, widened_eyes_, looked_size_};
}

ObjectStanding VisibilityPipeline::standing_of(ObjectId id) const {
  ObjectStanding standing;
  standing.threshold = options_.threshold_pixels;
  const auto is_above = [&](double mean) { return mean > std::max(standing.threshold, 0.0); };
  const double in_tiles = mean_of(refiner_.seen_in_tiles(), id);
  standing.pixels_mean = mean_of(filter_.means(), id);
  standing.pixels = filter_.newest_pixels_of(id);
  if (standing.pixels == 0 && in_tiles > 0.0) {
    standing.pixels = static_cast<std::uint32_t>(std::max(1.0, std::round(in_tiles)));
  }
  const auto has = [id](const std::vector<ObjectId>& ids) {
    return std::binary_search(ids.begin(), ids.end(), id);
  };
  if (has(boxed_) && has(counts_.ids)) {
    standing.state = WhyState::boxed;
  } else if (refiner_.complete()) {
    const double in_whole_view = guard_band_ ? mean_of(refiner_.seen_in_whole_view(), id) : 0.0;
    if (is_above(in_tiles) || is_above(in_whole_view)) standing.state = WhyState::visible;
  } else if (in_tiles > 0.0 || (standing.pixels > 0 && is_above(standing.pixels_mean))) {
    standing.state = WhyState::visible;
  } else if (is_above(standing.pixels_mean)) {
    standing.state = WhyState::held_by_filter;
  }
  if (!standing.state && added_open_ && has(counts_.open.ids)) standing.state = WhyState::open;
  if (!standing.state && standing.pixels > 0) standing.state = WhyState::below_threshold;
  return standing;
}

}  // namespace sightline
