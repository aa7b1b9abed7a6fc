#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/object_id.hpp"
#include "protocol/scene_data.hpp"
#include "protocol/visible_set.hpp"

namespace sightline {

/// What objects are beside their geometry: proxies that no set names, levels of detail that share one
/// identity, things that cast no shadow.
class SceneRoles {
 public:
  SceneRoles() = default;
  /// Of the objects of an uploaded scene, in their order.
  explicit SceneRoles(std::span<const SceneData::Object> objects);

  /// From what the engine saw to what the client is told: without the proxies, and each level of detail as
  /// the lowest id of its group.
  void apply(VisibleSet& visible) const;
  /// The id under which sets name an object.
  [[nodiscard]] ObjectId identity_of(ObjectId id) const noexcept;
  /// All objects that sets name as they name `id`, itself among them; ascending. Looks through all objects
  /// where there are groups: for questions that people ask.
  [[nodiscard]] std::vector<ObjectId> members_of(ObjectId id) const;
  /// Ascending.
  [[nodiscard]] const std::vector<ObjectId>& without_shadow() const noexcept { return without_shadow_; }

 private:
  std::vector<ObjectId> proxies_;         ///< ascending
  std::vector<ObjectId> without_shadow_;  ///< ascending
  std::vector<ObjectId> identity_;        ///< by object; empty where each is its own
};

}  // namespace sightline
