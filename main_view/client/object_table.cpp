#include "main_view/client/object_table.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include <glm/common.hpp>

#include "common/error.hpp"
#include "protocol/message_checks.hpp"
#include "protocol/scene_data.hpp"

namespace sightline {
namespace {

std::string name_of(ObjectId id) {
  return "object " + std::to_string(index_of(id));
}

bool is_placement(const glm::dmat4x3& matrix) {
  bool within = true;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row)
      within = within && std::abs(matrix[column][row]) <= k_max_matrix_entry;  // false for NaN
  }
  return within;
}

/// Finite with min <= max, or empty as a default box is.
bool is_box(const Aabb& box) {
  if (box == Aabb{}) return true;
  for (int axis = 0; axis < 3; ++axis) {
    const bool within = box.min[axis] >= -k_max_matrix_entry && box.min[axis] <= box.max[axis] &&
                        box.max[axis] <= k_max_matrix_entry;
    if (!within) return false;
  }
  return true;
}

void require_placement(ObjectId id, const glm::dmat4x3& matrix) {
  if (!is_placement(matrix))
    throw InputError("world_from_object of " + name_of(id) + " is not finite or too large");
}

void require_box(ObjectId id, const Aabb& box) {
  if (!is_box(box)) {
    throw InputError("bounds of " + name_of(id) +
                     " are not finite, too large or have min above max: give its box in its own frame");
  }
}

std::shared_ptr<const SceneObjects> validated(std::shared_ptr<const SceneObjects> scene) {
  if (scene->objects.size() + std::uint64_t{scene->spare_objects} > k_max_object_count)
    throw InputError("more objects than there are ids");
  for (std::size_t i = 0; i < scene->objects.size(); ++i) {
    const SceneObject& object = scene->objects[i];
    const ObjectId id{static_cast<std::uint32_t>(i)};
    require_placement(id, object.world_from_object);
    require_box(id, object.object_bounds);
    if ((object.flags & ~k_all_object_flags) != 0)
      throw InputError("flags of " + name_of(id) + " are unknown: give bits of ObjectFlag");
  }
  return scene;
}

/// As transformed() of common/bounds.hpp, for ten thousand objects a frame: rounded outwards by a little more
/// instead of by the next float.
Aabb placed(const Aabb& box, const glm::dmat4x3& world_from_object) noexcept {
  if (box.empty()) return box;
  const glm::dvec3 center = 0.5 * (glm::dvec3(box.min) + glm::dvec3(box.max));
  const glm::dvec3 half = 0.5 * (glm::dvec3(box.max) - glm::dvec3(box.min));
  const glm::dvec3& x = world_from_object[0];
  const glm::dvec3& y = world_from_object[1];
  const glm::dvec3& z = world_from_object[2];
  const glm::dvec3 at = world_from_object[3] + x * center.x + y * center.y + z * center.z;
  const glm::dvec3 reach = glm::abs(x) * half.x + glm::abs(y) * half.y + glm::abs(z) * half.z;
  const glm::dvec3 terms = glm::abs(world_from_object[3]) + glm::abs(x) * std::abs(center.x) +
                           glm::abs(y) * std::abs(center.y) + glm::abs(z) * std::abs(center.z) + reach;
  constexpr double k_ulp = 0x1p-23;
  const double pad = 6.0 * k_ulp * std::max({terms.x, terms.y, terms.z});
  return {glm::vec3(at - reach - pad), glm::vec3(at + reach + pad)};
}

std::vector<Aabb> world_bounds_of(const SceneObjects& scene) {
  std::vector<Aabb> bounds;
  bounds.reserve(scene.object_count());
  for (const SceneObject& object : scene.objects)
    bounds.push_back(placed(object.object_bounds, object.world_from_object));
  bounds.resize(scene.object_count());
  return bounds;
}

}  // namespace

void ObjectEdits::clear() noexcept {
  declared.clear();
  boxed.clear();
  moved.clear();
  hidden.clear();
  shown.clear();
  removed.clear();
}

ObjectTable::ObjectTable(std::shared_ptr<const SceneObjects> scene)
    : scene_(validated(std::move(scene))),
      object_bounds_(scene_->object_count()),
      world_from_object_(scene_->object_count(), glm::dmat4x3(1.0)),
      flags_(scene_->object_count(), 0),
      states_(scene_->object_count()),
      bounds_(world_bounds_of(*scene_)),
      ids_(static_cast<std::uint32_t>(scene_->objects.size()), scene_->spare_objects),
      listable_(word_count_of(scene_->object_count())),
      listable_in_shadow_(listable_.size()) {
  for (std::uint32_t i = 0; i < scene_->objects.size(); ++i) {
    const SceneObject& object = scene_->objects[i];
    object_bounds_[i] = object.object_bounds;
    world_from_object_[i] = object.world_from_object;
    flags_[i] = object.flags;
    states_[i].in_use = true;
    if (has(object.flags, ObjectFlag::always_visible)) always_visible_.push_back(ObjectId{i});
    mind_lists(ObjectId{i});
  }
  gather_groups();
}

void ObjectTable::gather_groups() {
  std::map<std::uint32_t, std::vector<ObjectId>> members;
  for (std::uint32_t i = 0; i < scene_->objects.size(); ++i) {
    if (scene_->objects[i].group != 0) members[scene_->objects[i].group].push_back(ObjectId{i});
  }
  if (members.empty()) return;
  group_.assign(object_count(), 0);
  group_begin_ = {0, 0};  // group 0 is nobody's
  for (const auto& [group, ids] : members) {
    for (const ObjectId id : ids) group_[index_of(id)] = static_cast<std::uint32_t>(group_begin_.size() - 1);
    group_members_.insert(group_members_.end(), ids.begin(), ids.end());
    group_begin_.push_back(static_cast<std::uint32_t>(group_members_.size()));
  }
}

std::span<const ObjectId> ObjectTable::group_of(ObjectId id) const noexcept {
  if (group_.empty()) return {};
  const std::uint32_t group = group_[index_of(id)];
  if (group == 0) return {};
  return std::span(group_members_)
      .subspan(group_begin_[group], group_begin_[group + 1] - group_begin_[group]);
}

void ObjectTable::require_id(ObjectId id) const {
  if (index_of(id) < object_count()) return;
  throw InputError(name_of(id) + " is not one of the scene's " + std::to_string(object_count()));
}

void ObjectTable::require_in_use(ObjectId id) const {
  require_id(id);
  if (states_[index_of(id)].in_use) return;
  throw InputError(name_of(id) + " is a spare id or was removed: add_object gives ids out");
}

ObjectTable::State& ObjectTable::touch(ObjectId id) {
  State& state = states_[index_of(id)];
  if (!state.touched) touched_.push_back(id);
  state.touched = true;
  return state;
}

void ObjectTable::place(ObjectId id) {
  const std::uint32_t i = index_of(id);
  bounds_.place(id, states_[i].in_use ? placed(object_bounds_[i], world_from_object_[i]) : Aabb{});
}

void ObjectTable::mind_lists(ObjectId id) {
  const std::uint32_t flags = flags_of(id);
  const bool listable = is_present(id) && !has(flags, ObjectFlag::occluder_only);
  set_bit(listable_, id, listable);
  set_bit(listable_in_shadow_, id, listable && !has(flags, ObjectFlag::casts_no_shadow));
}

void ObjectTable::move(std::span<const ObjectId> ids, std::span<const glm::dmat4x3> world_from_object) {
  if (ids.size() != world_from_object.size()) {
    throw InputError(std::to_string(ids.size()) + " ids and " + std::to_string(world_from_object.size()) +
                     " placements: give one for each");
  }
  for (std::size_t i = 0; i < ids.size(); ++i) {
    require_in_use(ids[i]);
    require_placement(ids[i], world_from_object[i]);
  }
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (world_from_object_[index_of(ids[i])] == world_from_object[i]) continue;
    world_from_object_[index_of(ids[i])] = world_from_object[i];
    State& state = touch(ids[i]);
    state.moved = state.ever_moved = true;
    place(ids[i]);
  }
}

void ObjectTable::hide(std::span<const ObjectId> ids) {
  for (const ObjectId id : ids) require_in_use(id);
  for (const ObjectId id : ids) {
    touch(id).hidden = true;
    mind_lists(id);
  }
}

void ObjectTable::show(std::span<const ObjectId> ids) {
  for (const ObjectId id : ids) require_in_use(id);
  for (const ObjectId id : ids) {
    touch(id).hidden = false;
    mind_lists(id);
  }
}

std::optional<ObjectId> ObjectTable::add(const SceneObject& object) {
  const ObjectId none{object_count()};
  require_placement(none, object.world_from_object);
  require_box(none, object.object_bounds);
  if ((object.flags & ~k_all_object_flags) != 0)
    throw InputError("flags of an added object are unknown: give bits of ObjectFlag");
  if (object.group != 0)
    throw InputError("an added object has a group: levels of detail come with the scene");
  if (has(object.flags, ObjectFlag::occluder_only))
    throw InputError("an added object is occluder_only: what is added hides nothing");
  const auto id = ids_.take();
  if (!id) return {};
  const std::uint32_t i = index_of(*id);
  object_bounds_[i] = object.object_bounds;
  world_from_object_[i] = object.world_from_object;
  State& state = touch(*id);
  state.in_use = state.boxed = state.newly_boxed = true;
  state.moved = state.ever_moved = true;
  state.hidden = false;
  state.empty = object.object_bounds.empty();
  place(*id);
  put_flags(*id, object.flags);
  return id;
}

void ObjectTable::remove(ObjectId id) {
  require_in_use(id);
  put_flags(id, flags_of(id) & ~static_cast<std::uint32_t>(ObjectFlag::always_visible));
  State& state = touch(id);
  state.in_use = false;
  state.removed = true;
  place(id);
  mind_lists(id);
}

void ObjectTable::set_bounds(std::span<const ObjectId> ids, std::span<const Aabb> object_bounds) {
  if (ids.size() != object_bounds.size()) {
    throw InputError(std::to_string(ids.size()) + " ids and " + std::to_string(object_bounds.size()) +
                     " boxes: give one for each");
  }
  for (std::size_t i = 0; i < ids.size(); ++i) {
    require_in_use(ids[i]);
    require_box(ids[i], object_bounds[i]);
  }
  for (std::size_t i = 0; i < ids.size(); ++i) {
    State& state = touch(ids[i]);
    state.newly_boxed = state.newly_boxed || !state.boxed;
    state.boxed = state.moved = state.ever_moved = true;
    state.empty = object_bounds[i].empty();
    object_bounds_[index_of(ids[i])] = object_bounds[i];
    place(ids[i]);
    mind_lists(ids[i]);
  }
}

void ObjectTable::set_flags(ObjectId id, std::uint32_t flags) {
  require_in_use(id);
  if ((flags & ~k_all_object_flags) != 0)
    throw InputError("flags of " + name_of(id) + " are unknown: give bits of ObjectFlag");
  if (((flags ^ flags_of(id)) & ~static_cast<std::uint32_t>(ObjectFlag::always_visible)) != 0) {
    throw InputError("flags of " + name_of(id) +
                     ": always_visible alone may change, the others are the scene's");
  }
  put_flags(id, flags);
}

/// The daemon goes on treating an id as the scene says: a proxy's is in no set, whoever has it now.
bool ObjectTable::may_be_reused(ObjectId id) const noexcept {
  if (index_of(id) >= scene_->objects.size()) return true;
  const SceneObject& object = scene_->objects[index_of(id)];
  return object.group == 0 && !has(object.flags, ObjectFlag::occluder_only) &&
         !has(object.flags, ObjectFlag::casts_no_shadow);
}

void ObjectTable::put_flags(ObjectId id, std::uint32_t flags) {
  flags_[index_of(id)] = flags;
  const auto at = std::lower_bound(always_visible_.begin(), always_visible_.end(), id);
  const bool listed = at != always_visible_.end() && *at == id;
  if (has(flags, ObjectFlag::always_visible) && !listed) always_visible_.insert(at, id);
  if (!has(flags, ObjectFlag::always_visible) && listed) always_visible_.erase(at);
  mind_lists(id);
}

MovedObject ObjectTable::as_it_is(ObjectId id) const {
  return {id, world_from_object_[index_of(id)], object_bounds_[index_of(id)]};
}

MovedObject ObjectTable::as_in_scene(ObjectId id) const {
  const SceneObject& object = scene_->objects[index_of(id)];
  return {id, object.world_from_object, object.object_bounds};
}

void ObjectTable::take_edits(ObjectEdits& edits) {
  edits.clear();
  if (!std::is_sorted(touched_.begin(), touched_.end())) std::sort(touched_.begin(), touched_.end());
  for (const ObjectId id : touched_) {
    State& state = states_[index_of(id)];
    const bool in_scene = index_of(id) < scene_->objects.size();
    if (!state.declared && in_scene) edits.declared.push_back(as_in_scene(id));
    state.declared = true;
    if (state.removed && may_be_reused(id)) edits.removed.push_back(id);
    if (!state.present() && !state.told_absent) edits.hidden.push_back(id);
    if (state.present() && state.told_absent) edits.shown.push_back(id);
    state.told_absent = !state.present();
    // A box with nothing in it is not told: the object is absent until it has one.
    if (state.in_use && !state.empty) {
      if (state.newly_boxed) {
        edits.boxed.push_back(as_it_is(id));
      } else if (state.moved) {
        edits.moved.push_back(as_it_is(id));
      }
      state.newly_boxed = false;
    }
    state.touched = state.moved = state.removed = false;
  }
  touched_.clear();
  bounds_.settle();
}

void ObjectTable::all_edits(ObjectEdits& edits) const {
  edits.clear();
  for (std::uint32_t i = 0; i < states_.size(); ++i) {
    const State& state = states_[i];
    if (!state.declared) continue;
    const ObjectId id{i};
    if (i < scene_->objects.size()) edits.declared.push_back(as_in_scene(id));
    if (state.told_absent) edits.hidden.push_back(id);
    if (!state.in_use || state.empty) continue;
    if (state.boxed) {
      edits.boxed.push_back(as_it_is(id));
    } else if (state.ever_moved) {
      edits.moved.push_back(as_it_is(id));
    }
  }
}

}  // namespace sightline
