#include "main_view/client/culling_core.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <utility>

#include <glm/geometric.hpp>

#include "common/error.hpp"
#include "main_view/client/field_coverage.hpp"

namespace sightline {
namespace {

template <typename Matrix>
bool is_finite(const Matrix& matrix) {
  for (glm::length_t column = 0; column < Matrix::length(); ++column) {
    for (glm::length_t row = 0; row < Matrix::col_type::length(); ++row) {
      if (!std::isfinite(matrix[column][row])) return false;
    }
  }
  return true;
}

/// Answers come this much later than the interval between them says, at times.
constexpr double k_interval_slack = 1.25;

/// Whether a product with zero is zero: not for an infinity, nor for NaN.
template <typename Vector>
Vector zeros_of(const Vector& vector) {
  return vector * typename Vector::value_type(0);
}

void require_finite(std::span<const MovedObject> objects) {
  for (const MovedObject& object : objects) {
    const glm::dmat4x3& place = object.world_from_object;
    const Aabb& bounds = object.object_bounds;
    const glm::dvec3 of_place =
        zeros_of(place[0]) + zeros_of(place[1]) + zeros_of(place[2]) + zeros_of(place[3]);
    const glm::vec3 of_bounds = zeros_of(bounds.min) + zeros_of(bounds.max);
    if (of_place == glm::dvec3(0.0) && (of_bounds == glm::vec3(0.0f) || bounds.empty())) continue;
    throw InputError("move of object " + std::to_string(index_of(object.id)) +
                     " is not finite: give a placement and the object's own bounds");
  }
}

void require_boxes(std::span<const BoxedPlacement> objects) {
  for (const BoxedPlacement& object : objects) {
    const auto& [low, high] = object.world_bounds;
    const bool finite = zeros_of(low) + zeros_of(high) == glm::dvec3(0.0);
    if (finite && low.x <= high.x && low.y <= high.y && low.z <= high.z) continue;
    throw InputError("box of object " + std::to_string(index_of(object.id)) +
                     " is not finite or has min above max: give its corners in world metres");
  }
}

/// What any of the sets saw in directions that the view reaches.
void unite_seen(std::span<const FiledSet* const> used, std::span<const Eye> eyes, FrameDecision& decision) {
  const std::vector<SeenSet::View> views(eyes.begin(), eyes.end());
  std::size_t words = 0;
  for (const FiledSet* filed : used) {
    const std::span<const ObjectId> ids = filed->seen.ids();
    if (!ids.empty()) words = std::max<std::size_t>(words, index_of(ids.back()) / 64 + 1);
  }
  std::vector<std::uint64_t>& bits = decision.visible_bits;
  bits.assign(words, 0);
  const auto bit_of = [](ObjectId id) { return std::uint64_t{1} << (index_of(id) % 64); };
  const auto kept = [&](ObjectId id) { return (bits[index_of(id) / 64] & bit_of(id)) != 0; };
  const auto keep = [&](ObjectId id) {
    std::uint64_t& word = bits[index_of(id) / 64];
    decision.visible_count += (word & bit_of(id)) == 0;
    word |= bit_of(id);
  };
  for (const FiledSet* filed : used) filed->seen.visit_in_view(filed->request.eyes, views, kept, keep);
}

/// The bits as a set.
VisibleSet set_of(std::span<const std::uint64_t> bits, std::size_t count) {
  std::vector<ObjectId> ids;
  ids.reserve(count);
  for (std::size_t word = 0; word < bits.size(); ++word) {
    for (std::uint64_t left = bits[word]; left != 0; left &= left - 1)
      ids.push_back(ObjectId{static_cast<std::uint32_t>(64 * word) +
                             static_cast<std::uint32_t>(std::countr_zero(left))});
  }
  return VisibleSet(ids);
}

CullingOptions validated(CullingOptions options) {
  options.validate();
  return options;
}

std::vector<RigEye> validated(std::vector<RigEye> rig) {
  if (rig.empty() || rig.size() > k_max_eyes) {
    throw InputError("rig has " + std::to_string(rig.size()) + " eyes: give 1 to " +
                     std::to_string(k_max_eyes));
  }
  for (const RigEye& eye : rig) {
    if (is_finite(eye.camera_from_head) && is_finite(eye.clip_from_camera)) continue;
    throw InputError(
        "rig has an eye whose matrices are not finite: give a rigid camera_from_head and a projection");
  }
  return rig;
}

}  // namespace

std::vector<Eye> eyes_of(const Pose& head, std::span<const RigEye> rig) {
  const glm::dmat4 head_from_world = camera_from_world(head);
  std::vector<Eye> eyes;
  eyes.reserve(rig.size());
  for (const RigEye& eye : rig)
    eyes.push_back({eye.camera_from_head * head_from_world, eye.clip_from_camera});
  return eyes;
}

CullingCore::CullingCore(CullingOptions options, std::vector<RigEye> rig)
    : options_(validated(options)),
      rig_(validated(std::move(rig))),
      history_(options_),
      predictor_(options_),
      horizon_(options_) {}

void CullingCore::drop_sets() noexcept {
  timeline_.clear();
  first_valid_request_seq_ = next_request_seq_;
}

void CullingCore::set_rig(std::vector<RigEye> rig) {
  rig_ = validated(std::move(rig));
  drop_sets();
  reset_pending_ = true;
}

void CullingCore::adjust_rig(std::vector<RigEye> rig) {
  rig_ = validated(std::move(rig));
}

void CullingCore::number_requests_from(std::uint64_t request_seq) noexcept {
  next_request_seq_ = first_valid_request_seq_ = request_seq;
}

std::optional<std::uint64_t> CullingCore::oldest_filed_request(double now_s) const noexcept {
  return timeline_.lowest_request_seq(now_s - options_.max_staleness_s);
}

void CullingCore::add_pose(const TimedPose& head) {
  const PoseHistory::Added added = history_.add(head);
  if (added == PoseHistory::Added::ignored) return;
  if (added == PoseHistory::Added::jumped) {
    drop_sets();
    reset_pending_ = true;
  }
  if (added != PoseHistory::Added::continued) predictor_.forget_pending();
  predictor_.observe(history_);
  if (head.time_s > frame_s_) last_frame_s_ = std::exchange(frame_s_, head.time_s);
}

void CullingCore::declare_objects(std::span<const MovedObject> objects) {
  require_finite(objects);
  moving_.declare(objects);
}

void CullingCore::move_objects(double now_s, std::span<const MovedObject> objects) {
  if (!std::isfinite(now_s)) throw InputError("time of moved objects is not finite: give seconds");
  require_finite(objects);
  const double before_s = frame_s_ < now_s ? frame_s_ : last_frame_s_;
  if (!moving_.move(now_s, before_s, objects)) drop_sets();
}

void CullingCore::box_objects(double now_s, std::span<const BoxedPlacement> objects) {
  if (!std::isfinite(now_s)) throw InputError("time of boxed objects is not finite: give seconds");
  require_boxes(objects);
  const double before_s = frame_s_ < now_s ? frame_s_ : last_frame_s_;
  if (!moving_.box(now_s, before_s, objects)) drop_sets();
}

void CullingCore::box_objects(double now_s, std::span<const MovedObject> objects) {
  require_finite(objects);
  std::vector<BoxedPlacement> boxes;
  boxes.reserve(objects.size());
  for (const MovedObject& object : objects)
    boxes.push_back({object.id, ObjectMotion(object.object_bounds, object.world_from_object).bounds()});
  box_objects(now_s, boxes);
}

void CullingCore::unbox_objects(std::span<const ObjectId> ids) {
  moving_.unbox(ids);
}

void CullingCore::hide_objects(std::span<const ObjectId> ids) {
  if (!moving_.hide(ids)) drop_sets();
}

void CullingCore::show_objects(std::span<const ObjectId> ids) {
  moving_.show(ids);
}

double CullingCore::guard_rad(const PredictedPose& predicted) const noexcept {
  // A set serves until the next one comes: so long the camera turns away from even a perfect prediction.
  const double turned_rad = history_.turn_speed_rad_per_s() * horizon_.answer_interval_s();
  return std::clamp(predicted.rotation_error_rad + turned_rad, options_.min_guard_rad,
                    options_.max_guard_rad);
}

ViewRequest CullingCore::begin_request(double for_time_s, ImageSize main_size) {
  ViewRequest request;
  request.request_seq = next_request_seq_++;
  request.for_time_s = for_time_s;
  request.main_size = main_size;
  request.reset_filter = reset_pending_;
  request.boxed = timeline_.take_spare_boxes();
  return request;
}

ViewRequest CullingCore::make_request(double now_s, ImageSize main_size) {
  if (history_.empty()) throw InputError("no camera pose yet: add one before making a request");
  const double newest_s = history_.newest().time_s;
  // A pose long past says nothing of now: beyond the largest horizon nothing is extrapolated.
  const double lead_s = std::min(now_s - newest_s + horizon_.horizon_s(), options_.max_horizon_s);

  ViewRequest request = begin_request(now_s + horizon_.horizon_s(), main_size);
  const PredictedPose predicted = predictor_.predict(history_, newest_s + lead_s);
  request.eyes = eyes_of(predicted.pose, rig_);
  if (lead_s > 0.0) {
    request.rotation_error_rad = guard_rad(predicted);
    request.position_error_m = predicted.position_error_m;
  }
  MovingObjects::Usage usage;
  usage.interval_s = horizon_.answer_interval_s();
  usage.from_s = request.for_time_s - use_lead_.upper();
  usage.until_s = request.for_time_s + k_interval_slack * usage.interval_s;
  usage.keep_s = options_.max_staleness_s + options_.max_horizon_s + 1.0;
  moving_.write(request, now_s, usage);
  return request;
}

ViewRequest CullingCore::make_exact_request(double now_s, ImageSize main_size, std::span<const Eye> eyes) {
  ViewRequest request = begin_request(now_s, main_size);
  request.eyes.assign(eyes.begin(), eyes.end());
  MovingObjects::Usage usage;
  usage.interval_s = horizon_.answer_interval_s();
  usage.from_s = usage.until_s = now_s;
  usage.keep_s = options_.max_staleness_s + options_.max_horizon_s + 1.0;
  moving_.write(request, now_s, usage);
  return request;
}

void CullingCore::accept(ViewRequest request, double issued_s, VisibleSet set, double received_s) {
  horizon_.observe(issued_s, received_s);
  use_lead_.add(std::max(request.for_time_s - received_s, 0.0));
  moving_.acknowledge(request.request_seq);
  if (request.request_seq < first_valid_request_seq_) return;
  reset_pending_ = false;
  timeline_.drop_before(received_s - options_.max_staleness_s);
  timeline_.file(std::move(request), std::move(set));
}

void CullingCore::forget_sets() {
  drop_sets();
  reset_pending_ = true;
  horizon_.restart_interval();
  moving_.forget_told();
}

bool CullingCore::usable(const FiledSet& filed, double now_s, std::span<const Eye> eyes) const {
  const double lead_s = filed.request.for_time_s - now_s;
  if (lead_s < -options_.max_staleness_s ||
      lead_s > std::max(options_.max_staleness_s, options_.max_horizon_s)) {
    return false;
  }
  if (filed.request.eyes.size() != eyes.size()) return false;
  const double limit_m = options_.max_position_offset_m + history_.speed_m_per_s() * std::abs(lead_s);
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    // Written so that NaN is not usable.
    if (!(glm::length(position_of(eyes[i]) - position_of(filed.request.eyes[i])) <= limit_m)) return false;
  }
  return true;
}

FrameDecision CullingCore::decide(double now_s, std::span<const Eye> eyes) const {
  FrameDecision decision = decide_in_bits(now_s, eyes);
  decision.visible = set_of(decision.visible_bits, decision.visible_count);
  return decision;
}

FrameDecision CullingCore::decide_in_bits(double now_s, std::span<const Eye> eyes) const {
  FrameDecision decision;
  decision.eye_count = eyes.size();
  const FiledSet* last = timeline_.last_at_or_before(now_s);
  const std::span<const FiledSet> next = timeline_.all_after(now_s);
  std::vector<const FiledSet*> used;
  if (last != nullptr && usable(*last, now_s, eyes)) {
    used.push_back(last);
    decision.last_age_s = now_s - last->request.for_time_s;
  }
  for (const FiledSet& filed : next) {
    if (!usable(filed, now_s, eyes)) continue;
    used.push_back(&filed);
    if (!decision.next_lead_s) decision.next_lead_s = filed.request.for_time_s - now_s;
    if (!options_.unite_all_later_sets) break;
  }
  decision.moved = moving_.judge(used);
  if (used.empty()) {
    decision.fallback = last == nullptr && next.empty() ? Fallback::no_set : Fallback::stale;
    return decision;
  }

  decision.fallback = Fallback::none;
  unite_seen(used, eyes, decision);
  decision.field_covered = true;
  decision.tested.reserve(used.size() * eyes.size());
  decision.fields.reserve(used.size() * eyes.size());
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    const ViewCorners corners = view_corners(eyes[i]);
    bool covered = false;
    for (const FiledSet* filed : used) {
      const TestedEye& tested = filed->tested[i];
      decision.tested.push_back(tested.world_field);
      decision.fields.push_back({i, cut_offs(tested, eyes[i], corners)});
      covered = covered || decision.fields.back().cuts.empty();
    }
    decision.field_covered = decision.field_covered && covered;
  }
  decision.field_covered = decision.field_covered || !options_.draw_untested;
  return decision;
}

double CullingCore::horizon_s() const noexcept {
  return horizon_.horizon_s();
}

}  // namespace sightline
