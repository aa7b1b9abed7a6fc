#include "main_view/client/moving_objects.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "protocol/message_checks.hpp"

namespace sightline {
namespace {

/// An extrapolation's error is forgotten by half in this time, seconds.
constexpr double k_error_half_life_s = 1.0;
/// The next error may be larger than those before.
constexpr double k_error_margin = 1.25;
/// Of the way to go, while little is known of how well it is foretold; and of the object's size.
constexpr double k_least_error_of_way = 0.02;
constexpr double k_least_error_of_size = 0.002;
/// No news for so many of its steps: it stands.
constexpr double k_steps_to_stop = 2.5;

/// As far as the wire goes; beyond, the box does not hold the object, which is then drawn.
WorldBox within_wire(const WorldBox& box) noexcept {
  constexpr glm::dvec3 k_limit(k_max_matrix_entry);
  const WorldBox clamped{glm::clamp(box.min, -k_limit, k_limit), glm::clamp(box.max, -k_limit, k_limit)};
  const bool ordered =
      (clamped.min.x <= clamped.max.x) & (clamped.min.y <= clamped.max.y) & (clamped.min.z <= clamped.max.z);
  return ordered ? clamped : WorldBox{-k_limit, k_limit};  // NaN, of numbers that no scene has
}

}  // namespace

std::uint32_t MovingObjects::add_slot(ObjectId id) {
  const auto slot = static_cast<std::uint32_t>(standing_.size());
  Standing& object = standing_.emplace_back();
  object.id = id;
  learnt_.emplace_back();
  News& news = news_.emplace_back();
  const std::uint32_t declared = declared_slots_.find(id);
  if (declared != IdSlots::k_none) {
    const Declared& file = declared_[declared];
    const ObjectMotion& motion = motions_.emplace_back(file.object_bounds, file.world_from_object);
    object.bounds = motion.bounds();
    object.placed = object.as_in_file = true;
    news.told.add({0, 0.0, ObjectState::resting, file.world_from_object, object.bounds});
  } else {
    motions_.emplace_back(Aabb{}, glm::dmat4x3(1.0));
  }
  slots_.set(id, slot);
  return slot;
}

std::uint32_t MovingObjects::slot_of(ObjectId id) {
  const std::uint32_t slot = slots_.find(id);
  return slot != IdSlots::k_none ? slot : add_slot(id);
}

void MovingObjects::activate(std::uint32_t slot) {
  Standing& object = standing_[slot];
  if (object.active) return;
  object.active = true;
  newcomers_.push_back(slot);
}

void MovingObjects::list_newcomers() {
  if (newcomers_.empty()) return;
  const auto by_id = [&](std::uint32_t a, std::uint32_t b) { return standing_[a].id < standing_[b].id; };
  if (!std::is_sorted(newcomers_.begin(), newcomers_.end(), by_id))
    std::sort(newcomers_.begin(), newcomers_.end(), by_id);
  const auto middle = static_cast<std::ptrdiff_t>(active_.size());
  active_.insert(active_.end(), newcomers_.begin(), newcomers_.end());
  std::inplace_merge(active_.begin(), active_.begin() + middle, active_.end(), by_id);
  newcomers_.clear();
}

/// From now on requests carry its box.
void MovingObjects::begin_moving(std::uint32_t slot) noexcept {
  standing_[slot].state = ObjectState::moving;
  standing_[slot].steady = false;
  learnt_[slot].foretold_since = foretold_.next_number();
}

void MovingObjects::declare(std::span<const MovedObject> objects) {
  for (const MovedObject& given : objects) {
    if (declared_slots_.find(given.id) != IdSlots::k_none) continue;
    const std::uint32_t slot = slots_.find(given.id);
    if (slot != IdSlots::k_none && standing_[slot].placed) continue;
    declared_slots_.set(given.id, static_cast<std::uint32_t>(declared_.size()));
    declared_.push_back({given.world_from_object, given.object_bounds});
    if (slot == IdSlots::k_none) continue;
    // It was hidden or boxed before.
    Standing& object = standing_[slot];
    motions_[slot] = ObjectMotion(given.object_bounds, given.world_from_object);
    object.placed = object.as_in_file = true;
    object.spare = false;
    if (!object.boxed) object.bounds = motions_[slot].bounds();
    if (news_[slot].told.empty()) {
      news_[slot].told.add({0, 0.0, ObjectState::resting, given.world_from_object, motions_[slot].bounds()});
    }
  }
}

/// Where it stands as geometry, of an object that is a box now or was not known of.
void MovingObjects::place(std::uint32_t slot, const MovedObject& given) {
  motions_[slot].set_object_bounds(given.object_bounds);
  motions_[slot].place(given.world_from_object);
  standing_[slot].placed = true;
  standing_[slot].as_in_file = false;
  news_[slot].move.begin();
}

bool MovingObjects::move(double now_s, double last_frame_s, std::span<const MovedObject> objects) {
  bool all_known = true;
  const ForetoldBoxes::Covering covering = foretold_.covering(now_s);
  for (const MovedObject& given : objects) {
    std::uint32_t slot = slots_.find(given.id);
    if (slot == IdSlots::k_none) {
      const std::uint32_t declared = declared_slots_.find(given.id);
      if (declared != IdSlots::k_none && declared_[declared].world_from_object == given.world_from_object) {
        declared_[declared].object_bounds = given.object_bounds;
        continue;
      }
      slot = add_slot(given.id);
    }
    Standing& object = standing_[slot];
    ObjectMotion& motion = motions_[slot];
    if (object.boxed) {
      if (motion.world_from_object() != given.world_from_object) place(slot, given);
      motion.set_object_bounds(given.object_bounds);
      step_box(slot, now_s, last_frame_s, motion.bounds(), covering);
      continue;
    }
    if (!object.placed) {
      place(slot, given);
      object.bounds = motion.bounds();
      all_known = all_known && object.state == ObjectState::absent;
      if (object.state != ObjectState::absent) activate(slot);
      continue;
    }
    motion.set_object_bounds(given.object_bounds);
    if (motion.world_from_object() == given.world_from_object) continue;
    activate(slot);
    Learnt& learnt = learnt_[slot];
    // An object that stood until now stood in the frame before as well.
    const bool stood =
        object.state != ObjectState::moving || now_s - learnt.changed_s > k_steps_to_stop * motion.step_s();
    const double from_s = stood ? std::max(learnt.changed_s, last_frame_s) : learnt.changed_s;
    const bool went_on = motion.step(std::min(from_s, now_s), now_s, given.world_from_object);
    if (!went_on) learnt.foretold_since = foretold_.next_number();
    object.bounds = motion.bounds();
    learnt.changed_s = now_s;
    object.as_in_file = false;
    if (!object.steady) news_[slot].move.begin();
    if (object.state == ObjectState::absent) continue;
    if (object.state != ObjectState::moving) begin_moving(slot);
    learn(slot, now_s, covering);
  }
  list_newcomers();
  return all_known;
}

bool MovingObjects::box(double now_s, double last_frame_s, std::span<const BoxedPlacement> objects) {
  bool all_known = true;
  const ForetoldBoxes::Covering covering = foretold_.covering(now_s);
  for (const BoxedPlacement& given : objects) {
    const std::uint32_t slot = slot_of(given.id);
    Standing& object = standing_[slot];
    if (object.boxed) {
      step_box(slot, now_s, last_frame_s, given.world_bounds, covering);
      continue;
    }
    ToldHistory& told = news_[slot].told;
    if (!object.placed && !object.active && told.empty()) {
      object.spare = true;
      told.add({0, 0.0, ObjectState::absent, glm::dmat4x3(1.0), {}});
    }
    object.boxed = true;
    if (object.box_slot == IdSlots::k_none) {
      object.box_slot = static_cast<std::uint32_t>(box_motions_.size());
      box_motions_.emplace_back();
    }
    box_motions_[object.box_slot] = BoxMotion();
    object.bounds = given.world_bounds;
    learnt_[slot].changed_s = now_s;
    if (object.state == ObjectState::absent) continue;
    all_known = all_known && !told.empty();
    begin_moving(slot);
    activate(slot);
  }
  list_newcomers();
  return all_known;
}

void MovingObjects::step_box(std::uint32_t slot, double now_s, double last_frame_s, const WorldBox& bounds,
                             const ForetoldBoxes::Covering& covering) {
  Standing& object = standing_[slot];
  if (object.bounds == bounds) return;
  Learnt& learnt = learnt_[slot];
  BoxMotion& motion = box_motions_[object.box_slot];
  const bool stood = now_s - learnt.changed_s > k_steps_to_stop * motion.step_s();
  const double from_s = stood ? std::max(learnt.changed_s, last_frame_s) : learnt.changed_s;
  const bool went_on = motion.step(std::min(from_s, now_s), now_s, object.bounds, bounds);
  if (!went_on) learnt.foretold_since = foretold_.next_number();
  object.bounds = bounds;
  learnt.changed_s = now_s;
  if (object.state != ObjectState::absent) learn(slot, now_s, covering);
}

void MovingObjects::unbox(std::span<const ObjectId> ids) {
  std::vector<ObjectId> gone;
  for (const ObjectId id : ids) {
    const std::uint32_t slot = slots_.find(id);
    if (slot == IdSlots::k_none || !standing_[slot].boxed) continue;
    Standing& object = standing_[slot];
    object.boxed = false;
    if (object.spare) gone.push_back(id);
    constexpr double k_infinity = std::numeric_limits<double>::infinity();
    object.bounds =
        object.placed ? motions_[slot].bounds() : WorldBox{glm::dvec3(-k_infinity), glm::dvec3(k_infinity)};
    if (object.spare || object.state == ObjectState::absent) continue;
    object.state = ObjectState::resting;
    object.steady = false;
    activate(slot);
  }
  (void)hide(gone);
  list_newcomers();
}

bool MovingObjects::hide(std::span<const ObjectId> ids) {
  bool all_known = true;
  const auto hidden_before = static_cast<std::ptrdiff_t>(absent_.size());
  for (const ObjectId id : ids) {
    const std::uint32_t slot = slot_of(id);
    Standing& object = standing_[slot];
    if (object.state == ObjectState::absent) continue;
    all_known = all_known && (object.placed || object.boxed || object.spare);
    object.state = ObjectState::absent;
    object.steady = false;
    if (!object.spare) {
      object.never_hidden = false;
      news_[slot].presence.begin();
    }
    learnt_[slot].foretold_since = foretold_.next_number();
    stop(slot);
    absent_.push_back(id);
    activate(slot);
  }
  std::sort(absent_.begin() + hidden_before, absent_.end());
  std::inplace_merge(absent_.begin(), absent_.begin() + hidden_before, absent_.end());
  list_newcomers();
  return all_known;
}

void MovingObjects::show(std::span<const ObjectId> ids) {
  bool any = false;
  for (const ObjectId id : ids) {
    const std::uint32_t slot = slots_.find(id);
    if (slot == IdSlots::k_none || standing_[slot].state != ObjectState::absent) continue;
    standing_[slot].state = ObjectState::resting;
    if (standing_[slot].boxed) begin_moving(slot);
    if (!standing_[slot].spare) news_[slot].presence.begin();
    activate(slot);
    any = true;
  }
  if (!any) return;
  std::erase_if(absent_,
                [&](ObjectId id) { return standing_[slots_.find(id)].state != ObjectState::absent; });
  list_newcomers();
}

/// Holds where the object is now against what was foretold for now.
void MovingObjects::learn(std::uint32_t slot, double now_s,
                          const ForetoldBoxes::Covering& covering) noexcept {
  Learnt& learnt = learnt_[slot];
  const double passed_s = std::max(now_s - learnt.error_s, 0.0);
  if (passed_s != decay_s_) {
    decay_s_ = passed_s;
    decay_ = std::exp2(-passed_s / k_error_half_life_s);
  }
  learnt.error_m *= decay_;
  learnt.error_s = now_s;
  for (std::size_t i = 0; i < covering.count; ++i) {
    const ForetoldBoxes::Column& column = *covering.columns[i];
    if (column.number < learnt.foretold_since) continue;
    learnt.error_m = std::max(learnt.error_m, excess_m(column.boxes[slot], standing_[slot].bounds));
  }
}

double MovingObjects::step_s(std::uint32_t slot) const noexcept {
  const Standing& object = standing_[slot];
  return object.boxed ? box_motions_[object.box_slot].step_s() : motions_[slot].step_s();
}

void MovingObjects::stop(std::uint32_t slot) noexcept {
  motions_[slot].stop();
  const std::uint32_t box_slot = standing_[slot].box_slot;
  if (box_slot != IdSlots::k_none) box_motions_[box_slot].stop();
}

/// Stops and rests what has not changed for long enough.
void MovingObjects::settle(std::uint32_t slot, double now_s, const Usage& usage,
                           const ForetoldBoxes::Covering& covering) {
  const double quiet_s = now_s - learnt_[slot].changed_s;
  if (!(quiet_s > 0.0)) return;
  if (quiet_s > k_steps_to_stop * step_s(slot)) stop(slot);
  learn(slot, now_s, covering);
  Standing& object = standing_[slot];
  if (object.boxed || quiet_s < std::max(k_rest_intervals * usage.interval_s, k_least_rest_s)) return;
  object.state = ObjectState::resting;
  object.steady = false;
}

WorldBox MovingObjects::box_of(std::uint32_t slot, double now_s, const Usage& usage,
                               ForetoldBoxes::Column* column) const {
  const Standing& object = standing_[slot];
  double speed_m_per_s = 0.0;
  WorldBox way;
  if (object.boxed) {
    const BoxMotion& motion = box_motions_[object.box_slot];
    way = motion.bounds_between(object.bounds, usage.from_s, usage.until_s);
    speed_m_per_s = motion.speed_m_per_s();
  } else {
    const ObjectMotion::Way foretold = motions_[slot].way_between(usage.from_s, usage.until_s);
    way = foretold.bounds;
    speed_m_per_s = foretold.speed_m_per_s;
  }
  if (column != nullptr) column->boxes[slot] = way;
  const double least_error_m = k_least_error_of_way * speed_m_per_s * (usage.until_s - now_s) +
                               k_least_error_of_size * glm::length(object.bounds.max - object.bounds.min);
  return within_wire(widened(way, k_error_margin * learnt_[slot].error_m + least_error_m));
}

/// Notes what request `seq` says of it, and forgets what requests said that are answered no more.
void MovingObjects::tell(std::uint32_t slot, std::uint64_t seq, double now_s, double keep_s) {
  Standing& object = standing_[slot];
  Told now{seq, now_s, object.state, glm::dmat4x3(1.0), {}};
  if (object.state == ObjectState::resting) {
    if (object.spare) {
      now.state = ObjectState::absent;
    } else if (!object.placed) {
      now.state = ObjectState::unknown;
    } else {
      now.world_from_object = motions_[slot].world_from_object();
      now.bounds = object.bounds;
    }
  }
  ToldHistory& told = news_[slot].told;
  told.add(now);
  told.forget_before(now_s - keep_s);
  object.boxed_since = now.state == ObjectState::moving ? told.newest().first_seq : k_never_told;
}

void MovingObjects::deliver(std::uint32_t slot, ViewRequest& request) {
  Standing& object = standing_[slot];
  News& news = news_[slot];
  if (object.state == ObjectState::resting && object.placed && news.move.due) {
    news.move.send(request.request_seq);
    request.moves.push_back({object.id, motions_[slot].world_from_object()});
  }
  if (news.presence.due) {
    news.presence.send(request.request_seq);
    request.presence.push_back({object.id, object.state != ObjectState::absent});
  }
  if (object.under_way || !(news.move.is_under_way() || news.presence.is_under_way())) return;
  object.under_way = true;
  under_way_.push_back(slot);
}

/// Whether all requests that may still be answered say of it what holds, and it need not be told.
bool MovingObjects::is_quiet(std::uint32_t slot) const noexcept {
  const Standing& object = standing_[slot];
  const News& news = news_[slot];
  return object.state != ObjectState::moving && news.told.is_settled() &&
         !(news.move.due && object.state == ObjectState::resting) && !news.presence.due;
}

void MovingObjects::write(ViewRequest& request, double now_s, const Usage& usage) {
  Usage from_now = usage;
  from_now.from_s = std::max(usage.from_s, now_s);
  from_now.until_s = std::max(usage.until_s, from_now.from_s);
  ForetoldBoxes::Column* column = foretold_.begin(now_s, from_now.from_s, from_now.until_s, standing_.size());
  const ForetoldBoxes::Covering covering = foretold_.covering(now_s, column);
  request.boxed.reserve(active_.size());
  std::size_t kept = 0;
  for (const std::uint32_t slot : active_) {
    Standing& object = standing_[slot];
    if (object.state == ObjectState::moving) settle(slot, now_s, from_now, covering);
    if (!object.steady) tell(slot, request.request_seq, now_s, usage.keep_s);
    if (object.state == ObjectState::moving)
      request.boxed.push_back({object.id, box_of(slot, now_s, from_now, column)});
    if (!object.steady) {
      deliver(slot, request);
      const News& news = news_[slot];
      object.steady = object.state == ObjectState::moving && news.told.is_settled() && !news.presence.due;
      if (is_quiet(slot)) {
        object.active = false;
        continue;
      }
    }
    active_[kept++] = slot;
  }
  active_.resize(kept);
}

void MovingObjects::acknowledge(std::uint64_t request_seq) noexcept {
  std::erase_if(under_way_, [&](std::uint32_t slot) {
    News& news = news_[slot];
    news.move.acknowledge(request_seq);
    news.presence.acknowledge(request_seq);
    standing_[slot].under_way = news.move.is_under_way() || news.presence.is_under_way();
    return !standing_[slot].under_way;
  });
}

void MovingObjects::forget_told() {
  for (std::uint32_t slot = 0; slot < standing_.size(); ++slot) {
    Standing& object = standing_[slot];
    News& news = news_[slot];
    news.told.clear();
    if (!object.as_in_file && object.placed) news.move.begin();
    if (!object.never_hidden) news.presence.begin();
    object.steady = false;
    object.boxed_since = k_never_told;
    activate(slot);
  }
  list_newcomers();
}

}  // namespace sightline
