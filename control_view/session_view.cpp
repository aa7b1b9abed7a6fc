#include "control_view/session_view.hpp"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "control_view/explain.hpp"

namespace sightline {
namespace {

struct EncodedSet {
  std::uint64_t base_seq = 0;
  std::vector<std::uint8_t> bitmap;
};

/// The difference from the set the client holds, or the whole set where that is as short.
EncodedSet encode_against(const VisibleSet* held, std::uint64_t held_seq, const VisibleSet& set) {
  if (held == nullptr) return {0, encode_keyframe(set)};
  const bool differs_more_than_it_holds = held->bitmap().xor_cardinality(set.bitmap()) > set.size();
  if (differs_more_than_it_holds) return {0, encode_keyframe(set)};
  return {held_seq, encode_delta(*held, set)};
}

/// Of a group of levels of detail; more levels than any thing has.
constexpr std::size_t k_most_members_explained = 8;

PipelineOptions with_size(PipelineOptions options, ImageSize size) {
  options.size = size;
  return options;
}

}  // namespace

SessionView::SessionView(std::uint8_t view, const PipelineOptions& options, Clock clock)
    : view_(view),
      options_(options),
      clock_(std::move(clock)),
      size_(options.size),
      pipeline_(options, clock_) {}

bool SessionView::accept(ViewRequest request, double now_s) {
  if (!is_news(request)) return true;
  newest_request_seq_ = request.request_seq;
  const bool supersedes = pending_.has_value();
  if (supersedes && pending_->request.reset_filter) request.reset_filter = true;
  if (!supersedes) waits_since_s_ = now_s;
  pending_ = PendingRequest{std::move(request), now_s};
  return supersedes;
}

void SessionView::keep_edits(const SceneEdits& edits) {
  if (!pending_ || pending_->edits != nullptr) return;
  auto kept = std::make_unique<SceneEdits>(edits);
  kept->view = view_;
  pending_->edits = std::move(kept);
}

/// An object that casts no shadow is not there for a light.
const SceneEdits& SessionView::edits_for(ViewKind kind, const ServedScene& scene, const SceneEdits& edits) {
  const std::vector<ObjectId>& without_shadow = scene.roles.without_shadow();
  if (kind != ViewKind::shadow_map || without_shadow.empty()) return edits;
  if (shadow_version_ == edits.version) return shadow_edits_;
  shadow_version_ = edits.version;
  shadow_edits_ = edits;
  // They need an owner of their own, or an engine would take them for the session's. Ids of sessions are
  // random: the neighbour of one is nobody's. And version 0 would say that nothing was edited.
  shadow_edits_.owner = edits.owner ^ 1;
  shadow_edits_.version = edits.version + 1;
  shadow_edits_.hidden.clear();
  std::set_union(edits.hidden.begin(), edits.hidden.end(), without_shadow.begin(), without_shadow.end(),
                 std::back_inserter(shadow_edits_.hidden));
  return shadow_edits_;
}

VisibleSetFrame SessionView::answer(ServedScene& scene, const SceneEdits& edits, double now_s) {
  PendingRequest pending = *std::exchange(pending_, std::nullopt);
  ViewRequest& request = pending.request;
  const bool another_kind = std::exchange(kind_, request.view_kind) != request.view_kind;
  if (std::exchange(reset_due_, false) || another_kind) request.reset_filter = true;
  const ImageSize size = request.control_size == ImageSize{} ? options_.size : request.control_size;
  if (size != size_) {
    size_ = size;
    pipeline_ = VisibilityPipeline(with_size(options_, size), clock_);
  }
  Look look = pipeline_.look(
      request, edits_for(request.view_kind, scene, pending.edits ? *pending.edits : edits), *scene.engine);
  scene.roles.apply(look.visible);

  sent_.acknowledge(request.acked_set_seq);
  const VisibleSet* const held = sent_.find(request.acked_set_seq);
  settle_extents(held, look.visible);
  EncodedSet encoded = encode_against(held, request.acked_set_seq, look.visible);
  EncodedExtents extents = encode_extents(encoded.base_seq == 0 ? nullptr : held, look.visible);

  VisibleSetFrame frame;
  frame.view = view_;
  frame.request_seq = request.request_seq;
  frame.for_time_s = request.for_time_s;
  frame.scene_digest = scene.identity.digest;
  frame.base_seq = encoded.base_seq;
  frame.visible_count = static_cast<std::uint32_t>(look.visible.size());
  frame.bitmap = std::move(encoded.bitmap);
  frame.extents_of = std::move(extents.ids);
  frame.extents = std::move(extents.cells);
  frame.times = look.times;
  frame.times.queue_s = now_s - pending.received_s;
  frame.times.encode_s = last_encode_s_;
  frame.drawn_objects = look.drawn_objects;
  frame.set_seq = sent_.add(std::move(look.visible));
  boxed_ = std::move(request.boxed);
  return frame;
}

WhyAnswer SessionView::why(const Why& question, ServedScene& scene, const SceneEdits& edits) {
  const SceneEdits& seen_edits = edits_for(kind_, scene, edits);
  std::optional<WhyAnswer> strongest;
  // Each is a look of its own, and a group may have as many members as the scene has objects.
  std::size_t looks = 0;
  for (const ObjectId member : scene.roles.members_of(question.object_id)) {
    if (looks++ == k_most_members_explained) break;
    Why of_member = question;
    of_member.object_id = member;
    WhyAnswer answer = explain(of_member, pipeline_, boxed_, seen_edits, *scene.engine);
    strongest = strongest ? stronger_of(*std::move(strongest), std::move(answer)) : std::move(answer);
  }
  strongest->object_id = question.object_id;
  return *std::move(strongest);
}

}  // namespace sightline
