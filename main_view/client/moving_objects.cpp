#include "main_view/client/moving_objects.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "protocol/message_checks.hpp"

namespace sightline {
namespace {

/// As far as the wire goes; beyond, the box does not hold the object, which is then drawn.
WorldBox within_wire(const WorldBox& box) noexcept {
  constexpr glm::dvec3 k_limit(k_max_matrix_entry);
  const WorldBox clamped{glm::clamp(box.min, -k_limit, k_limit), glm::clamp(box.max, -k_limit, k_limit)};
  const bool ordered =
      (clamped.min.x <= clamped.max.x) & (clamped.min.y <= clamped.max.y) & (clamped.min.z <= clamped.max.z);
  return ordered ? clamped : WorldBox{-k_limit, k_limit};  // NaN, of numbers that no scene has
}

/// `way` and as far around it as it may be off, as MotionKernel does it. `bounds`: where the object is now.
WorldBox with_doubt(const WorldBox& way, double error_m, double speed_m_per_s, const WorldBox& bounds,
                    const ForetellTimes& times) noexcept {
  const double least_error_m = k_least_error_of_way * speed_m_per_s * (times.until_s - times.now_s) +
                               k_least_error_of_size * glm::length(bounds.max - bounds.min);
  return within_wire(widened(way, k_error_margin * error_m + least_error_m));
}

WorldBox box_in(const BoxRows& rows, std::uint32_t slot) noexcept {
  const std::size_t i = MotionBlocks::lane(slot);
  return {{rows.min[0][i], rows.min[1][i], rows.min[2][i]}, {rows.max[0][i], rows.max[1][i], rows.max[2][i]}};
}

void put_box(const WorldBox& box, std::uint32_t slot, BoxRows& rows) noexcept {
  const std::size_t i = MotionBlocks::lane(slot);
  for (int axis = 0; axis < 3; ++axis) {
    rows.min[axis][i] = box.min[axis];
    rows.max[axis][i] = box.max[axis];
  }
}

}  // namespace

std::uint32_t MovingObjects::add_slot(ObjectId id) {
  const auto slot = static_cast<std::uint32_t>(standing_.size());
  Standing& object = standing_.emplace_back();
  object.id = id;
  News& news = news_.emplace_back();
  const std::uint32_t declared = declared_slots_.find(id);
  if (declared != IdSlots::k_none) {
    const Declared& file = declared_[declared];
    motions_.add(file.object_bounds, file.world_from_object);
    object.placed = object.as_in_file = true;
    news.told.add({0, 0.0, ObjectState::resting, file.world_from_object, motions_.bounds(slot)});
  } else {
    motions_.add(Aabb{}, glm::dmat4x3(1.0));
  }
  moving_lanes_.resize(motions_.block_count(), 0);
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

void MovingObjects::set_state(std::uint32_t slot, ObjectState state) noexcept {
  Standing& object = standing_[slot];
  object.state = state;
  const auto bit = static_cast<std::uint8_t>(1u << MotionBlocks::lane(slot));
  std::uint8_t& lanes = moving_lanes_[slot / k_block_lanes];
  lanes = state == ObjectState::moving && !object.boxed ? lanes | bit : lanes & ~bit;
}

/// From now on requests carry its box.
void MovingObjects::begin_moving(std::uint32_t slot) noexcept {
  set_state(slot, ObjectState::moving);
  standing_[slot].steady = false;
  forget_foretold(slot);
}

/// What was foretold so far is not about it.
void MovingObjects::forget_foretold(std::uint32_t slot) noexcept {
  motions_.forget_foretold_before(slot, foretold_.next_number());
  if (standing_[slot].box_slot != IdSlots::k_none)
    boxes_[standing_[slot].box_slot].foretold_since = foretold_.next_number();
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
    motions_.set_motion(slot, ObjectMotion(given.object_bounds, given.world_from_object));
    object.placed = object.as_in_file = true;
    object.spare = false;
    if (news_[slot].told.empty()) {
      news_[slot].told.add({0, 0.0, ObjectState::resting, given.world_from_object, motions_.bounds(slot)});
    }
  }
}

/// Where it stands as geometry, of an object that is a box now or was not known of.
void MovingObjects::place(std::uint32_t slot, const MovedObject& given) {
  ObjectMotion motion = motions_.motion(slot);
  motion.set_object_bounds(given.object_bounds);
  motion.place(given.world_from_object);
  motions_.set_motion(slot, motion);
  standing_[slot].placed = true;
  standing_[slot].as_in_file = false;
  news_[slot].move.begin();
}

bool MovingObjects::move(double now_s, double last_frame_s, std::span<const MovedObject> objects) {
  bool all_known = true;
  const ForetoldBoxes::Covering covering = foretold_.covering(now_s);
  MotionSteps steps(motions_, {now_s, last_frame_s, foretold_.next_number()}, covering);
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
    if (object.boxed) {
      steps.flush();
      if (motions_.world_from_object(slot) != given.world_from_object) place(slot, given);
      if (motions_.object_bounds(slot) != given.object_bounds)
        motions_.set_object_bounds(slot, given.object_bounds);
      step_box(slot, now_s, last_frame_s, motions_.bounds(slot), covering);
      continue;
    }
    if (!object.placed) {
      steps.flush();
      place(slot, given);
      all_known = all_known && object.state == ObjectState::absent;
      if (object.state != ObjectState::absent) activate(slot);
      continue;
    }
    if (motions_.object_bounds(slot) != given.object_bounds) {
      steps.flush();
      motions_.set_object_bounds(slot, given.object_bounds);
    }
    if (motions_.world_from_object(slot) == given.world_from_object) continue;
    const bool stood = object.state != ObjectState::moving;
    steps.add(slot, given.object_bounds, given.world_from_object, stood);
    if (object.steady) continue;
    activate(slot);
    object.as_in_file = false;
    news_[slot].move.begin();
    if (stood && object.state != ObjectState::absent) begin_moving(slot);
  }
  steps.flush();
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
      object.box_slot = static_cast<std::uint32_t>(boxes_.size());
      boxes_.emplace_back();
    }
    boxes_[object.box_slot] = BoxCourse();
    boxes_[object.box_slot].bounds = given.world_bounds;
    boxes_[object.box_slot].changed_s = now_s;
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
  BoxCourse& box = boxes_[standing_[slot].box_slot];
  if (box.bounds == bounds) return;
  const bool stood = now_s - box.changed_s > k_steps_to_stop * box.motion.step_s();
  const double from_s = stood ? std::max(box.changed_s, last_frame_s) : box.changed_s;
  const bool went_on = box.motion.step(std::min(from_s, now_s), now_s, box.bounds, bounds);
  if (!went_on) box.foretold_since = foretold_.next_number();
  box.bounds = bounds;
  box.changed_s = now_s;
  if (standing_[slot].state != ObjectState::absent) learn(slot, now_s, covering);
}

void MovingObjects::unbox(std::span<const ObjectId> ids) {
  std::vector<ObjectId> gone;
  for (const ObjectId id : ids) {
    const std::uint32_t slot = slots_.find(id);
    if (slot == IdSlots::k_none || !standing_[slot].boxed) continue;
    Standing& object = standing_[slot];
    object.boxed = false;
    if (object.spare) gone.push_back(id);
    if (object.spare || object.state == ObjectState::absent) continue;
    set_state(slot, ObjectState::resting);
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
    set_state(slot, ObjectState::absent);
    object.steady = false;
    if (!object.spare) {
      object.never_hidden = false;
      news_[slot].presence.begin();
    }
    forget_foretold(slot);
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
    set_state(slot, ObjectState::resting);
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

/// Holds where a box is now against what was foretold for now.
void MovingObjects::learn(std::uint32_t slot, double now_s,
                          const ForetoldBoxes::Covering& covering) noexcept {
  BoxCourse& box = boxes_[standing_[slot].box_slot];
  box.error_m *= std::exp2(-std::max(now_s - box.error_s, 0.0) / k_error_half_life_s);
  box.error_s = now_s;
  const ForetoldRows foretold = covering.rows(slot / k_block_lanes);
  for (std::size_t i = 0; i < foretold.count; ++i) {
    if (foretold.numbers[i] - box.foretold_since < 0) continue;
    box.error_m = std::max(box.error_m, excess_m(box_in(*foretold.boxes[i], slot), box.bounds));
  }
}

void MovingObjects::stop(std::uint32_t slot) noexcept {
  motions_.stop(slot);
  const std::uint32_t box_slot = standing_[slot].box_slot;
  if (box_slot != IdSlots::k_none) boxes_[box_slot].motion.stop();
}

/// Where the objects of a block will be, and which of them have come to rest.
void MovingObjects::foretell_block(std::size_t block, const Asking& asking) {
  asked_in_[block] = write_count_;
  const std::uint32_t moving = moving_lanes_[block];
  BoxRows not_kept;
  BoxRows& way = asking.column != nullptr ? asking.column->boxes[block] : not_kept;
  const Foretold found =
      motions_.foretell(block, moving, asking.times, asking.covering.rows(block), way, asked_[block]);
  const auto for_each = [&](std::uint32_t lanes, const auto& work) {
    for (; lanes != 0; lanes &= lanes - 1)
      work(static_cast<std::uint32_t>(k_block_lanes * block) +
           static_cast<std::uint32_t>(std::countr_zero(lanes)));
  };
  for_each(found.rested, [&](std::uint32_t slot) {
    set_state(slot, ObjectState::resting);
    standing_[slot].steady = false;
  });
  for_each(found.turning_fast & moving & ~found.rested,
           [&](std::uint32_t slot) { foretell_turning(slot, asking, way); });
}

void MovingObjects::foretell_turning(std::uint32_t slot, const Asking& asking, BoxRows& way) {
  const ObjectMotion motion = motions_.motion(slot);
  const ObjectMotion::Way foretold = motion.way_between(asking.times.from_s, asking.times.until_s);
  put_box(foretold.bounds, slot, way);
  const WorldBox box = with_doubt(foretold.bounds, motions_.error_m(slot), foretold.speed_m_per_s,
                                  motions_.bounds(slot), asking.times);
  put_box(box, slot, asked_[slot / k_block_lanes]);
}

/// Of an object on the move, which is looked at for the first time in this request.
WorldBox MovingObjects::box_of_boxed(std::uint32_t slot, const Asking& asking) {
  BoxCourse& box = boxes_[standing_[slot].box_slot];
  const double quiet_s = asking.times.now_s - box.changed_s;
  if (quiet_s > 0.0) {
    if (quiet_s > k_steps_to_stop * box.motion.step_s()) stop(slot);
    learn(slot, asking.times.now_s, asking.covering);
  }
  const WorldBox way = box.motion.bounds_between(box.bounds, asking.times.from_s, asking.times.until_s);
  if (asking.column != nullptr) put_box(way, slot, asking.column->boxes[slot / k_block_lanes]);
  return with_doubt(way, box.error_m, box.motion.speed_m_per_s(), box.bounds, asking.times);
}

/// Notes what request `seq` says of it, and forgets what requests said that are answered no more.
void MovingObjects::tell(std::uint32_t slot, std::uint64_t seq, double now_s, double keep_s) {
  Standing& object = standing_[slot];
  ToldHistory& told = news_[slot].told;
  if (object.state == ObjectState::moving && object.boxed_since != k_never_told) {  // as the request before
    told.forget_before(now_s - keep_s);
    return;
  }
  Told now{seq, now_s, object.state, glm::dmat4x3(1.0), {}};
  if (object.state == ObjectState::resting) {
    if (object.spare) {
      now.state = ObjectState::absent;
    } else if (!object.placed) {
      now.state = ObjectState::unknown;
    } else {
      now.world_from_object = motions_.world_from_object(slot);
      now.bounds = bounds_of(slot);
    }
  }
  told.add(now);
  told.forget_before(now_s - keep_s);
  object.boxed_since = now.state == ObjectState::moving ? told.newest().first_seq : k_never_told;
}

void MovingObjects::deliver(std::uint32_t slot, ViewRequest& request) {
  Standing& object = standing_[slot];
  News& news = news_[slot];
  if (object.state == ObjectState::resting && object.placed && news.move.due) {
    news.move.send(request.request_seq);
    request.moves.push_back({object.id, motions_.world_from_object(slot)});
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
  Asking asking;
  ForetellTimes& times = asking.times;
  times.now_s = now_s;
  times.from_s = std::max(usage.from_s, now_s);
  times.until_s = std::max(usage.until_s, times.from_s);
  times.rest_s = std::max(k_rest_intervals * usage.interval_s, k_least_rest_s);
  asking.column = foretold_.begin(now_s, times.from_s, times.until_s, motions_.block_count());
  asking.covering = foretold_.covering(now_s, asking.column);
  asked_.resize(motions_.block_count());
  asked_in_.resize(motions_.block_count(), 0);
  ++write_count_;
  request.boxed.reserve(active_.size());
  std::size_t kept = 0;
  for (const std::uint32_t slot : active_) {
    Standing& object = standing_[slot];
    const std::size_t block = slot / k_block_lanes;
    if (asked_in_[block] != write_count_) foretell_block(block, asking);
    if (object.state == ObjectState::moving)
      request.boxed.push_back(
          {object.id, object.boxed ? box_of_boxed(slot, asking) : box_in(asked_[block], slot)});
    if (!object.steady) {
      tell(slot, request.request_seq, now_s, usage.keep_s);
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
