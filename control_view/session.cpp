#include "control_view/session.hpp"

#include <algorithm>
#include <utility>

namespace sightline {

Session::Session(std::uint64_t id, PeerId peer, std::string client_name, ServedScenePtr scene,
                 const PipelineOptions& options, Clock clock, double now_s)
    : peer_(std::move(peer)),
      client_name_(std::move(client_name)),
      scene_(std::move(scene)),
      options_(options),
      clock_(std::move(clock)),
      last_heard_s_(now_s) {
  edits_.owner = id;
  ++scene_->sessions;
}

Session::~Session() {
  --scene_->sessions;
  scene_->last_used_s = clock_();
}

bool Session::silent(double before_s, double now_s, double grace_s) noexcept {
  if (last_heard_s_ >= before_s) return false;
  if (!missed_since_s_) missed_since_s_ = now_s;
  return now_s - *missed_since_s_ > grace_s;
}

bool Session::accept(ViewRequest request, double now_s) {
  std::unique_ptr<SessionView>& view = views_[request.view];
  if (view == nullptr) view = std::make_unique<SessionView>(request.view, options_, clock_);
  if (!view->is_news(request)) return true;
  if (!request.moves.empty() || !request.presence.empty()) {
    for (const auto& other : views_) {
      if (other != nullptr && other != view) other->keep_edits(edits_);
    }
  }
  const bool jumped = apply_moves(edits_, std::move(request.moves));
  const bool changed = apply_presence(edits_, request.presence);
  request.moves.clear();
  request.presence.clear();
  if (jumped || changed) {
    for (const auto& each : views_) {
      if (each != nullptr && each->pipeline().remembers_absence()) each->reset_filter();
    }
  }
  return view->accept(std::move(request), now_s);
}

bool Session::has_request() const noexcept {
  return std::any_of(views_.begin(), views_.end(),
                     [](const auto& view) { return view != nullptr && view->has_pending(); });
}

VisibleSetFrame Session::answer(double now_s) {
  SessionView* longest = nullptr;
  for (std::uint32_t i = 0; i < views_.size(); ++i) {
    SessionView* const view = views_[i].get();
    if (view == nullptr || !view->has_pending()) continue;
    if (longest != nullptr && view->waits_since_s() >= longest->waits_since_s()) continue;
    longest = view;
    edits_.view = i;
  }
  VisibleSetFrame frame = longest->answer(*scene_, edits_, now_s);
  frame.session_id = id();
  return frame;
}

WhyAnswer Session::answer_why() {
  const Why question = questions_.take();
  if (SessionView* view = views_[question.view].get()) return view->why(question, *scene_, edits_);
  WhyAnswer unknown;
  unknown.session_id = question.session_id;
  unknown.nonce = question.nonce;
  unknown.view = question.view;
  unknown.object_id = question.object_id;
  return unknown;
}

void Session::note_encode_time(std::uint8_t view, double encode_s) noexcept {
  if (views_[view] != nullptr) views_[view]->note_encode_time(encode_s);
}

}  // namespace sightline
