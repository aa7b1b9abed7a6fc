#include "control_view/scene_roles.hpp"

#include <algorithm>
#include <unordered_map>
#include <utility>

namespace sightline {

SceneRoles::SceneRoles(std::span<const SceneData::Object> objects) {
  std::unordered_map<std::uint32_t, ObjectId> lowest_of_group;
  for (std::uint32_t i = 0; i < objects.size(); ++i) {
    const SceneData::Object& object = objects[i];
    const ObjectId id{i};
    if (has(object.flags, ObjectFlag::occluder_only)) proxies_.push_back(id);
    if (has(object.flags, ObjectFlag::casts_no_shadow)) without_shadow_.push_back(id);
    if (object.group == 0) continue;
    const ObjectId lowest = lowest_of_group.try_emplace(object.group, id).first->second;
    if (lowest == id) continue;
    if (identity_.empty()) {
      identity_.reserve(objects.size());
      for (std::uint32_t k = 0; k < objects.size(); ++k) identity_.push_back(ObjectId{k});
    }
    identity_[i] = lowest;
  }
}

ObjectId SceneRoles::identity_of(ObjectId id) const noexcept {
  return index_of(id) < identity_.size() ? identity_[index_of(id)] : id;
}

std::vector<ObjectId> SceneRoles::members_of(ObjectId id) const {
  if (identity_.empty()) return {id};
  std::vector<ObjectId> members;
  for (std::uint32_t i = 0; i < identity_.size(); ++i) {
    if (identity_[i] == identity_of(id)) members.push_back(ObjectId{i});
  }
  return members;
}

void SceneRoles::apply(VisibleSet& visible) const {
  if (proxies_.empty() && identity_.empty()) return;
  const std::vector<ObjectId> seen = visible.to_ids();
  const std::span<const DirectionExtent> extents = visible.extents();
  struct Told {
    ObjectId id;
    DirectionExtent extent;
  };
  std::vector<Told> told;
  told.reserve(seen.size());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (std::binary_search(proxies_.begin(), proxies_.end(), seen[i])) continue;
    told.push_back({identity_of(seen[i]), extents.empty() ? k_seen_anywhere : extents[i]});
  }
  std::stable_sort(told.begin(), told.end(), [](const Told& a, const Told& b) { return a.id < b.id; });
  std::vector<ObjectId> ids;
  std::vector<DirectionExtent> where;
  for (const Told& entry : told) {
    if (!ids.empty() && ids.back() == entry.id) {
      where.back() = united(where.back(), entry.extent);
      continue;
    }
    ids.push_back(entry.id);
    where.push_back(entry.extent);
  }
  visible = VisibleSet(ids);
  if (!extents.empty()) visible.set_extents(std::move(where));
}

}  // namespace sightline
