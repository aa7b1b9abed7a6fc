#include <algorithm>

#include "main_view/client/cast_shadows.hpp"
#include "main_view/client/moving_objects.hpp"

namespace sightline {
namespace {

/// Walks the boxes of a request beside the ascending ids that are asked for.
class BoxCursor {
 public:
  explicit BoxCursor(const std::vector<BoxedObject>& boxed) noexcept
      : at_(boxed.data()), end_(boxed.data() + boxed.size()) {}

  /// The object's box; null when the request has none. Ids must ascend from call to call.
  const BoxedObject* find(ObjectId id) noexcept {
    while (at_ != end_ && at_->id < id) ++at_;
    return at_ != end_ && at_->id == id ? at_ : nullptr;
  }

 private:
  const BoxedObject* at_;
  const BoxedObject* end_;
};

bool holds(const BoxedObject* box, const WorldBox& inner) noexcept {
  if (box == nullptr) return false;
  const WorldBox& outer = box->world_bounds;
  return (outer.min.x <= inner.min.x) & (outer.min.y <= inner.min.y) & (outer.min.z <= inner.min.z) &
         (outer.max.x >= inner.max.x) & (outer.max.y >= inner.max.y) & (outer.max.z >= inner.max.z);
}

}  // namespace

bool MovingObjects::misjudged(std::uint32_t slot, const FiledSet& filed, const BoxedObject* box,
                              std::vector<ShadowToBe>& shadows, bool& everything) const {
  const Standing& object = standing_[slot];
  const Told* told = news_[slot].told.at(filed.request.request_seq);
  if (told == nullptr) return everything = true;  // a set from before the object was heard of
  switch (told->state) {
    case ObjectState::unknown:
      // Appeared where the file has it, and stays there; unless it is a box now.
      everything = everything || object.boxed;
      return object.boxed;
    case ObjectState::absent:
      return true;
    case ObjectState::moving:
      return !holds(box, object.bounds);
    case ObjectState::resting:
      if (object.state != ObjectState::absent && !object.boxed &&
          told->world_from_object == motions_[slot].world_from_object()) {
        return false;
      }
      cast_shadows(*told, filed.request, shadows);
      return true;
  }
  return true;
}

MovedInFrame MovingObjects::judge(std::span<const FiledSet* const> used) const {
  MovedInFrame moved;
  moved.absent = absent_;
  if (used.empty()) return moved;
  std::uint64_t oldest_seq = k_never_told;
  std::vector<BoxCursor> cursors;
  cursors.reserve(used.size());
  for (const FiledSet* filed : used) {
    oldest_seq = std::min(oldest_seq, filed->request.request_seq);
    cursors.emplace_back(filed->request.boxed);
  }
  std::vector<ShadowToBe> shadows;
  for (const std::uint32_t slot : active_) {
    const Standing& object = standing_[slot];
    bool untested = false;
    if (object.boxed_since <= oldest_seq) {
      for (BoxCursor& cursor : cursors) untested |= !holds(cursor.find(object.id), object.bounds);
    } else {
      shadows.clear();
      for (std::size_t i = 0; i < used.size(); ++i) {
        const BoxedObject* box = cursors[i].find(object.id);
        untested |= misjudged(slot, *used[i], box, shadows, moved.everything);
      }
      if (moved.shadows.size() + shadows.size() > k_most_shadows) moved.everything = true;
      if (moved.everything) return moved;  // nothing else matters then
      for (const ShadowToBe& shadow : shadows)
        moved.shadows.emplace_back(*shadow.eye, shadow.told->bounds, shadow.slack_m);
    }
    if (untested && object.state != ObjectState::absent) moved.untested.push_back(object.id);
  }
  return moved;
}

}  // namespace sightline
