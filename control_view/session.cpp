#include "control_view/session.hpp"

#include <utility>

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

}  // namespace

Session::Session(std::uint64_t id, PeerId peer, std::string client_name, VisibilityPipeline pipeline,
                 double now_s)
    : peer_(std::move(peer)),
      client_name_(std::move(client_name)),
      pipeline_(std::move(pipeline)),
      last_heard_s_(now_s) {
  edits_.owner = id;
}

bool Session::silent(double before_s, double now_s, double grace_s) noexcept {
  if (last_heard_s_ >= before_s) return false;
  if (!missed_since_s_) missed_since_s_ = now_s;
  return now_s - *missed_since_s_ > grace_s;
}

bool Session::accept(ViewRequest request, double now_s) {
  if (request.request_seq < newest_request_seq_) return true;
  newest_request_seq_ = request.request_seq;
  const bool jumped = apply_moves(edits_, std::move(request.moves));
  const bool changed = apply_presence(edits_, request.presence);
  if ((jumped || changed) && pipeline_.remembers_absence()) request.reset_filter = true;
  request.moves.clear();
  request.presence.clear();

  const bool supersedes = pending_.has_value();
  if (supersedes && pending_->request.reset_filter) request.reset_filter = true;
  pending_ = PendingRequest{std::move(request), now_s};
  return supersedes;
}

VisibleSetFrame Session::answer(VisibilityEngine& engine, const SceneDigest& digest, double now_s) {
  const PendingRequest pending = *std::exchange(pending_, std::nullopt);
  const ViewRequest& request = pending.request;
  Look look = pipeline_.look(request, edits_, engine);

  sent_.acknowledge(request.acked_set_seq);
  const VisibleSet* const held = sent_.find(request.acked_set_seq);
  settle_extents(held, look.visible);
  EncodedSet encoded = encode_against(held, request.acked_set_seq, look.visible);
  EncodedExtents extents = encode_extents(encoded.base_seq == 0 ? nullptr : held, look.visible);

  VisibleSetFrame frame;
  frame.session_id = id();
  frame.request_seq = request.request_seq;
  frame.for_time_s = request.for_time_s;
  frame.scene_digest = digest;
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
  return frame;
}

}  // namespace sightline
