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

/// Whether some boxes hold another one; two of its sides at a time.
class HeldBox {
 public:
  explicit HeldBox(const WorldBox& inner) noexcept
      : a_{inner.min.x, inner.min.y}, b_{inner.min.z, -inner.max.x}, c_{inner.max.y, inner.max.z} {}

  /// False for NaN.
  [[nodiscard]] bool in(const BoxedObject* box) const noexcept {
    if (box == nullptr) return false;
    const auto& [min, max] = box->world_bounds;
    const Sides held = (Pair{min.x, min.y} <= a_) & (Pair{min.z, -max.x} <= b_) & (Pair{max.y, max.z} >= c_);
    return (held[0] & held[1]) != 0;
  }

 private:
  using Pair = double __attribute__((vector_size(16)));
  using Sides = std::int64_t __attribute__((vector_size(16)));
  Pair a_, b_, c_;
};

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
      return !HeldBox(bounds_of(slot)).in(box);
    case ObjectState::resting:
      if (object.state != ObjectState::absent && !object.boxed &&
          told->world_from_object == motions_.world_from_object(slot)) {
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
      const HeldBox bounds(bounds_of(slot));
      for (BoxCursor& cursor : cursors) untested |= !bounds.in(cursor.find(object.id));
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
