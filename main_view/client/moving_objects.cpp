#include "main_view/client/moving_objects.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "common/view.hpp"
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

}  // namespace

bool MovedInFrame::is_absent(ObjectId id) const noexcept {
  return std::binary_search(absent.begin(), absent.end(), id);
}

bool MovedInFrame::must_draw(ObjectId id, const Aabb& world_bounds) const noexcept {
  return everything || std::binary_search(untested.begin(), untested.end(), id) ||
         std::any_of(shadows.begin(), shadows.end(),
                     [&](const OccluderShadow& shadow) { return shadow.may_hold(world_bounds); });
}

MovingObjects::Tracked& MovingObjects::track(ObjectId id) {
  return objects_.try_emplace(id, Tracked{ObjectMotion(Aabb{}, glm::dmat4x3(1.0))}).first->second;
}

void MovingObjects::declare(std::span<const MovedObject> objects) {
  for (const MovedObject& given : objects) {
    Tracked& object = track(given.id);
    if (object.placed) continue;
    object.motion = ObjectMotion(given.object_bounds, given.world_from_object);
    object.bounds = object.motion.bounds();
    object.placed = object.as_in_file = true;
    if (object.told.empty())
      object.told.push_back({0, 0.0, State::resting, given.world_from_object, object.bounds});
  }
}

bool MovingObjects::move(double now_s, double last_frame_s, std::span<const MovedObject> objects) {
  bool all_known = true;
  for (const MovedObject& given : objects) {
    Tracked& object = track(given.id);
    if (!object.placed) {
      object.motion = ObjectMotion(given.object_bounds, given.world_from_object);
      object.bounds = object.motion.bounds();
      object.placed = true;
      object.move.begin();
      all_known = all_known && object.state == State::absent;
      if (object.state != State::absent) active_.insert(given.id);
      continue;
    }
    object.motion.set_object_bounds(given.object_bounds);
    if (object.motion.world_from_object() == given.world_from_object) continue;
    active_.insert(given.id);
    // An object that stood until now stood in the frame before as well.
    const bool stood =
        object.state != State::moving || now_s - object.changed_s > k_steps_to_stop * object.motion.step_s();
    const double from_s = stood ? std::max(object.changed_s, last_frame_s) : object.changed_s;
    const bool went_on = object.motion.step(std::min(from_s, now_s), now_s, given.world_from_object);
    if (!went_on) object.foretold.clear();
    object.bounds = object.motion.bounds();
    object.changed_s = now_s;
    object.as_in_file = false;
    object.move.begin();
    if (object.state == State::absent) continue;
    object.state = State::moving;
    learn(object, now_s);
  }
  return all_known;
}

bool MovingObjects::hide(std::span<const ObjectId> ids) {
  bool all_known = true;
  for (const ObjectId id : ids) {
    Tracked& object = track(id);
    if (object.state == State::absent) continue;
    all_known = all_known && object.placed;
    object.state = State::absent;
    object.never_hidden = false;
    object.presence.begin();
    object.foretold.clear();
    object.motion.stop();
    absent_.insert(id);
    active_.insert(id);
  }
  return all_known;
}

void MovingObjects::show(std::span<const ObjectId> ids) {
  for (const ObjectId id : ids) {
    if (absent_.erase(id) == 0) continue;
    Tracked& object = track(id);
    object.state = State::resting;
    object.presence.begin();
    active_.insert(id);
  }
}

/// Holds where the object is now against what was foretold for now.
void MovingObjects::learn(Tracked& object, double now_s) const {
  while (!object.foretold.empty() && object.foretold.front().until_s < now_s) object.foretold.pop_front();
  object.error_m *= std::exp2(-std::max(now_s - object.error_s, 0.0) / k_error_half_life_s);
  object.error_s = now_s;
  for (const Foretold& foretold : object.foretold) {
    if (foretold.from_s <= now_s && now_s <= foretold.until_s)
      object.error_m = std::max(object.error_m, excess_m(foretold.bounds, object.bounds));
  }
}

/// Stops and rests what has not changed for long enough.
void MovingObjects::settle(Tracked& object, double now_s, const Usage& usage) const {
  if (object.state != State::moving) return;
  const double quiet_s = now_s - object.changed_s;
  if (quiet_s > k_steps_to_stop * object.motion.step_s()) object.motion.stop();
  if (quiet_s > 0.0) learn(object, now_s);
  if (quiet_s < std::max(k_rest_intervals * usage.interval_s, k_least_rest_s)) return;
  object.state = State::resting;
  object.foretold.clear();
}

WorldBox MovingObjects::box_of(Tracked& object, double now_s, const Usage& usage) const {
  const double from_s = std::max(usage.from_s, now_s), until_s = std::max(usage.until_s, from_s);
  const WorldBox way = object.motion.bounds_between(from_s, until_s);
  const bool due =
      object.foretold.empty() || from_s - object.foretold.back().from_s > (until_s - now_s) / k_most_foretold;
  if (due) object.foretold.push_back({from_s, until_s, way});
  const WorldBox& here = object.bounds;
  const double least_error_m = k_least_error_of_way * object.motion.speed_m_per_s() * (until_s - now_s) +
                               k_least_error_of_size * glm::length(here.max - here.min);
  WorldBox box = widened(way, k_error_margin * object.error_m + least_error_m);
  // As far as the wire goes; beyond, the box does not hold the object, which is then drawn.
  box.min = glm::clamp(box.min, -k_max_matrix_entry, k_max_matrix_entry);
  box.max = glm::clamp(box.max, -k_max_matrix_entry, k_max_matrix_entry);
  return box;
}

void MovingObjects::tell(Tracked& object, std::uint64_t seq, double now_s) const {
  Told now{seq, now_s, object.state, {}, {}};
  if (object.state == State::resting) {
    if (!object.placed) now.state = State::unknown;
    now.world_from_object = object.motion.world_from_object();
    now.bounds = object.bounds;
  }
  const bool same = !object.told.empty() && object.told.back().state == now.state &&
                    object.told.back().world_from_object == now.world_from_object;
  if (!same) object.told.push_back(now);
}

/// Whether all requests that may still be answered say of it what holds, and it need not be told.
bool MovingObjects::is_quiet(const Tracked& object) noexcept {
  return object.state != State::moving && object.told.size() == 1 &&
         !(object.move.due && object.state == State::resting) && !object.presence.due;
}

void MovingObjects::write(ViewRequest& request, double now_s, const Usage& usage) {
  for (auto at = active_.begin(); at != active_.end();) {
    const ObjectId id = *at;
    Tracked& object = objects_.at(id);
    settle(object, now_s, usage);
    tell(object, request.request_seq, now_s);
    while (object.told.size() > 1 && object.told[1].time_s < now_s - usage.keep_s)
      object.told.erase(object.told.begin());

    if (object.state == State::moving) request.boxed.push_back({id, box_of(object, now_s, usage)});
    if (object.state == State::resting && object.placed && object.move.due) {
      object.move.send(request.request_seq);
      request.moves.push_back({id, object.motion.world_from_object()});
    }
    if (object.presence.due) {
      object.presence.send(request.request_seq);
      request.presence.push_back({id, object.state != State::absent});
    }
    at = is_quiet(object) ? active_.erase(at) : std::next(at);
  }
}

void MovingObjects::acknowledge(std::uint64_t request_seq) noexcept {
  for (const ObjectId id : active_) {
    Tracked& object = objects_.at(id);
    object.move.acknowledge(request_seq);
    object.presence.acknowledge(request_seq);
  }
}

void MovingObjects::forget_told() noexcept {
  for (auto& [id, object] : objects_) {
    object.told.clear();
    if (!object.as_in_file && object.placed) object.move.begin();
    if (!object.never_hidden) object.presence.begin();
    active_.insert(id);
  }
}

void MovingObjects::cast(const Told& told, const ViewRequest& request, std::vector<Cast>& casts) {
  for (const Eye& eye : request.eyes) {
    const bool sharable = OccluderShadow::depends_on_place_alone(eye);
    const auto shared = std::find_if(casts.begin(), casts.end(), [&](const Cast& cast) {
      return sharable && cast.told == &told && OccluderShadow::depends_on_place_alone(*cast.eye) &&
             glm::length(position_of(eye) - position_of(*cast.eye)) <= k_shared_shadow_m;
    });
    if (shared == casts.end()) {
      casts.push_back({&told, &eye, request.position_error_m});
    } else {
      const double apart_m = glm::length(position_of(eye) - position_of(*shared->eye));
      shared->slack_m = std::max(shared->slack_m, apart_m + request.position_error_m);
    }
  }
}

bool MovingObjects::misjudged(ObjectId id, const Tracked& object, const FiledSet& filed,
                              std::vector<Cast>& casts, bool& everything) {
  const auto after =
      std::upper_bound(object.told.begin(), object.told.end(), filed.request.request_seq,
                       [](std::uint64_t seq, const Told& told) { return seq < told.first_seq; });
  if (after == object.told.begin()) return everything = true;  // a set from before the object was known of
  const Told& told = *std::prev(after);
  switch (told.state) {
    case State::unknown:
      return false;  // appeared where the file has it, and stays there
    case State::absent:
      return true;
    case State::moving: {
      const auto& boxed = filed.request.boxed;
      const auto box = std::lower_bound(boxed.begin(), boxed.end(), id,
                                        [](const BoxedObject& entry, ObjectId of) { return entry.id < of; });
      return box == boxed.end() || box->id != id || excess_m(box->world_bounds, object.bounds) > 0.0;
    }
    case State::resting:
      if (object.state != State::absent && told.world_from_object == object.motion.world_from_object())
        return false;
      cast(told, filed.request, casts);
      return true;
  }
  return true;
}

MovedInFrame MovingObjects::judge(std::span<const FiledSet* const> used) const {
  MovedInFrame moved;
  moved.absent.assign(absent_.begin(), absent_.end());
  std::vector<Cast> casts;
  for (const ObjectId id : active_) {
    const Tracked& object = objects_.at(id);
    casts.clear();
    bool untested = false;
    for (const FiledSet* filed : used)
      untested = misjudged(id, object, *filed, casts, moved.everything) || untested;
    if (untested && object.state != State::absent) moved.untested.push_back(id);
    if (moved.shadows.size() + casts.size() > k_most_shadows) moved.everything = true;
    if (moved.everything) continue;
    for (const Cast& cast : casts) moved.shadows.emplace_back(*cast.eye, cast.told->bounds, cast.slack_m);
  }
  return moved;
}

}  // namespace sightline
