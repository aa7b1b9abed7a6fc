#pragma once

#include <algorithm>
#include <vector>

#include "common/bounds.hpp"
#include "common/object_id.hpp"
#include "main_view/client/occluder_shadow.hpp"

namespace sightline {

/// What the objects that moved, came or went add to a frame's decision.
struct MovedInFrame {
  std::vector<ObjectId> absent;         ///< not there: not drawn, whatever else holds; ascending
  std::vector<ObjectId> untested;       ///< no set in use looked for them where they are: drawn; ascending
  std::vector<OccluderShadow> shadows;  ///< where a set in use may have missed what is no longer hidden
  bool everything = false;              ///< more shadows than are worth testing: all in the view is drawn;
                                        ///< `untested` and `shadows` are then not complete

  /// Whether must_draw is false for everything.
  [[nodiscard]] bool draws_nothing() const noexcept {
    return !everything && untested.empty() && shadows.empty();
  }
  [[nodiscard]] bool is_absent(ObjectId id) const noexcept {
    return !absent.empty() && std::binary_search(absent.begin(), absent.end(), id);
  }
  [[nodiscard]] bool must_draw(ObjectId id, const Aabb& world_bounds) const noexcept {
    return everything || (!untested.empty() && std::binary_search(untested.begin(), untested.end(), id)) ||
           std::any_of(shadows.begin(), shadows.end(),
                       [&](const OccluderShadow& shadow) { return shadow.may_hold(world_bounds); });
  }
};

}  // namespace sightline
