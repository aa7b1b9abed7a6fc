#include "main_view/client/view_culler.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "protocol/scene_data.hpp"

namespace sightline {

void ViewCuller::cull(const ObjectTable& objects, std::span<const Eye> eyes, FrameDecision decision,
                      ViewFrame& frame) {
  frusta_.clear();
  for (const Eye& eye : eyes) frusta_.emplace_back(frustum_of(eye.clip_from_world()));
  frame.decision_ = std::move(decision);
  frame.object_count_ = objects.object_count();
  frame.bits_.assign(word_count_of(objects.object_count()), 0);
  if (frame.fallback() != Fallback::none || frame.decision_.moved.everything) {
    mark_in_view(objects, frame);
  } else {
    mark_seen(objects, frame);
    mark_moved(objects, frame);
    mark_untested(objects, frame);
    for (const ObjectId id : objects.always_visible()) {
      if (any_may_hold(frusta_, objects.bounds().bounds_of(id))) mark(objects, id, frame);
    }
  }
  finish(objects, frame);
}

/// The object, with the others of its group: levels of detail of one thing come and go together.
void ViewCuller::mark(const ObjectTable& objects, ObjectId id, ViewFrame& frame) const {
  set_bit(frame.bits_, id);
  for (const ObjectId member : objects.group_of(id)) set_bit(frame.bits_, member);
}

void ViewCuller::mark_in_view(const ObjectTable& objects, ViewFrame& frame) {
  for (const FrustumTester& frustum : frusta_)
    objects.bounds().visit(frustum, scratch_, [&](ObjectId id) { mark(objects, id, frame); });
}

/// The decision's set as a list.
void ViewCuller::gather_seen(const FrameDecision& decision, std::uint32_t object_count) {
  seen_.clear();
  if (decision.visible_bits.empty()) {
    const RoaringBitmap& seen = decision.visible.bitmap();
    seen_.resize(seen.cardinality());
    seen.toUint32Array(seen_.data());
  }
  for (std::size_t word = 0; word < decision.visible_bits.size(); ++word) {
    for (std::uint64_t bits = decision.visible_bits[word]; bits != 0; bits &= bits - 1)
      seen_.push_back(
          static_cast<std::uint32_t>(64 * word + static_cast<std::size_t>(std::countr_zero(bits))));
  }
  while (!seen_.empty() && seen_.back() >= object_count) seen_.pop_back();  // of a scene that is not ours
}

void ViewCuller::mark_seen(const ObjectTable& objects, ViewFrame& frame) {
  gather_seen(frame.decision_, objects.object_count());
  const auto in_view = [&](ObjectId id) { return any_may_hold(frusta_, objects.bounds().bounds_of(id)); };
  // The boxes of a set lie far apart in memory: the next ones are on their way while one is tested.
  constexpr std::size_t k_ahead = 12;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    if (i + k_ahead < seen_.size())
      __builtin_prefetch(&objects.bounds().bounds_of(ObjectId{seen_[i + k_ahead]}));
    const ObjectId id{seen_[i]};
    const auto members = objects.group_of(id);
    const bool any_in_view =
        members.empty() ? in_view(id) : std::any_of(members.begin(), members.end(), [&](ObjectId member) {
          return objects.is_present(member) && in_view(member);
        });
    if (any_in_view) mark(objects, id, frame);
  }
}

void ViewCuller::mark_moved(const ObjectTable& objects, ViewFrame& frame) {
  const MovedInFrame& moved = frame.decision_.moved;
  for (const ObjectId id : moved.untested) {
    if (any_may_hold(frusta_, objects.bounds().bounds_of(id))) mark(objects, id, frame);
  }
  for (const OccluderShadow& shadow : moved.shadows) {
    const auto holds = [&](const Aabb& box) { return shadow.may_hold(box) && any_may_hold(frusta_, box); };
    objects.bounds().visit(holds, [&](ObjectId id) { mark(objects, id, frame); });
  }
}

/// What reaches into a part of an eye's view that none of the sets has looked at.
void ViewCuller::mark_untested(const ObjectTable& objects, ViewFrame& frame) {
  const FrameDecision& decision = frame.decision_;
  if (decision.field_covered) return;
  const auto holds = [&](const Aabb& box) {
    return any_may_hold(frusta_, box) && decision.may_be_untested(box);
  };
  objects.bounds().visit(holds, [&](ObjectId id) { mark(objects, id, frame); });
}

/// Takes away what is not to be listed at all, and makes the list.
void ViewCuller::finish(const ObjectTable& objects, ViewFrame& frame) const {
  const ObjectBits& listable =
      kind_ == ViewKind::shadow_map ? objects.listable_in_shadow() : objects.listable();
  frame.ids_.clear();
  for (std::size_t word = 0; word < frame.bits_.size(); ++word) {
    std::uint64_t bits = frame.bits_[word] &= listable[word];
    for (; bits != 0; bits &= bits - 1) {
      const auto bit = static_cast<std::size_t>(std::countr_zero(bits));
      frame.ids_.push_back(ObjectId{static_cast<std::uint32_t>(64 * word + bit)});
    }
  }
}

WhyReason ViewCuller::why(const ObjectTable& objects, std::span<const Eye> eyes, const ViewFrame& frame,
                          ObjectId id) const {
  const std::uint32_t flags = objects.flags_of(id);
  if (!objects.is_present(id)) return WhyReason::hidden_by_application;
  if (has(flags, ObjectFlag::occluder_only)) return WhyReason::occluder_only;
  if (kind_ == ViewKind::shadow_map && has(flags, ObjectFlag::casts_no_shadow))
    return WhyReason::casts_no_shadow;
  const Aabb& bounds = objects.bounds().bounds_of(id);
  const bool in_view = std::any_of(eyes.begin(), eyes.end(), [&](const Eye& eye) {
    return may_intersect(frustum_of(eye.clip_from_world()), bounds);
  });
  if (!in_view && !frame.is_visible(id)) return WhyReason::outside_frustum;
  if (has(flags, ObjectFlag::always_visible)) return WhyReason::always_visible;
  const FrameDecision& decision = frame.decision();
  if (decision.fallback != Fallback::none) {
    return decision.fallback == Fallback::no_set ? WhyReason::no_set : WhyReason::stale;
  }
  const auto members = objects.group_of(id);
  const ObjectId identity = members.empty() ? id : members.front();
  if (decision.is_seen(identity)) return WhyReason::unknown;
  if (std::binary_search(decision.moved.untested.begin(), decision.moved.untested.end(), id))
    return WhyReason::moved_untested;
  if (decision.moved.must_draw(id, bounds)) return WhyReason::uncovered_by_a_mover;
  return frame.is_visible(id) ? WhyReason::field_not_tested : WhyReason::unknown;
}

}  // namespace sightline
