#include "main_view/client/scene_upload.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>
#include <variant>

#include "protocol/codec.hpp"
#include "protocol/scene_chunk_frame.hpp"
#include "protocol/scene_chunks.hpp"
#include "protocol/visible_set.hpp"

namespace sightline {
namespace {

constexpr int k_max_frames_a_poll = 256;  // a daemon gone mad must not hold up the picture
constexpr int k_max_chunks_a_poll = 64;   // nor must a link that takes everything
constexpr double k_longest_backoff = 4.0;
constexpr double k_ask_again_s = 1.0;  // nothing happens: how is it?
constexpr double k_lost_s = 5.0;       // nothing still: the connection is gone
constexpr int k_most_failures = 3;     // uploads that a daemon forgets before we give up

}  // namespace

SceneUpload::SceneUpload(const std::string& endpoint, const LinkOptions& link,
                         std::shared_ptr<const PackedScene> scene, double retry_interval_s)
    : options_(link), link_(endpoint, link), scene_(std::move(scene)), retry_interval_s_(retry_interval_s) {}

void SceneUpload::offer(double now_s, bool anew) {
  if (anew) {
    link_.reconnect();
    chunks_on_link_ = 0;
  }
  offer_due_ = !link_.send(encode(scene_->offer));
  answer_due_ = true;
  offered_s_ = now_s;
  missing_.clear();
}

void SceneUpload::wait(double timeout_s) {
  const auto wait =
      std::chrono::milliseconds(static_cast<int>(std::ceil(std::clamp(timeout_s, 0.0, 1.0) * 1000.0)));
  if (const auto frame = link_.receive(wait)) take_frame(*frame);
}

SceneUpload::State SceneUpload::poll(double now_s) {
  for (int i = 0; i < k_max_frames_a_poll; ++i) {
    const auto frame = link_.receive(std::chrono::milliseconds(0));
    if (!frame) break;
    take_frame(*frame);
  }
  if (state_ == State::ready || state_ == State::failed) return state_;
  if (!polled_) lively_s_ = now_s;
  polled_ = true;
  if (std::exchange(heard_, false)) {
    lively_s_ = now_s;
    backoff_ = 1.0;
  }
  if (offer_due_) offer(now_s, std::exchange(reconnect_due_, false));
  send_chunks(now_s);
  // Behind the chunks on their way, so that the answer knows of them.
  if (state_ == State::uploading && missing_.empty() && std::exchange(chunks_lost_, false))
    offer(now_s, false);
  mind_silence(now_s);
  return state_;
}

void SceneUpload::send_chunks(double now_s) {
  for (int i = 0; i < k_max_chunks_a_poll && !missing_.empty(); ++i) {
    const std::uint32_t index = missing_.back();
    const auto bytes = chunk_of(scene_->bytes, index);
    if (unsent_.empty()) unsent_ = encode_scene_chunk({scene_->offer.scene_digest, index, bytes});
    if (!link_.send(unsent_)) return;
    unsent_ = {};
    missing_.pop_back();
    ++chunks_on_link_;
    chunk_bytes_sent_ += bytes.size();
    lively_s_ = now_s;
  }
}

void SceneUpload::mind_silence(double now_s) {
  const double silent_s = now_s - lively_s_;
  if (state_ == State::offering) {
    if (now_s - offered_s_ < retry_interval_s_ * backoff_) return;
    backoff_ = std::min(2.0 * backoff_, k_longest_backoff);
    offer(now_s, true);
  } else if (silent_s > k_lost_s) {
    state_ = State::offering;
    lively_s_ = now_s;
    offer(now_s, true);
  } else if (silent_s > k_ask_again_s && missing_.empty() && now_s - offered_s_ > k_ask_again_s) {
    offer(now_s, false);
  }
}

void SceneUpload::take_frame(const Bytes& frame) {
  DecodeLimits limits;
  limits.max_frame_bytes = options_.max_frame_bytes;
  auto decoded = decode(frame, limits);
  const auto* message = std::get_if<Message>(&decoded);
  if (message == nullptr) return;
  heard_ = true;
  if (const auto* status = std::get_if<SceneStatus>(message)) on_status(*status);
  if (const auto* refusal = std::get_if<Refusal>(message)) on_refusal(*refusal);
  if (const auto* ping = std::get_if<Ping>(message)) link_.send(encode(Pong{ping->nonce, ping->time_s}));
}

void SceneUpload::on_status(const SceneStatus& status) {
  const auto& chunks = scene_->offer.chunk_digests;
  if (status.scene_digest != scene_->offer.scene_digest) return;
  if (state_ == State::ready || state_ == State::failed) return;
  if (reconnect_due_) return;  // of a connection that is given up
  switch (status.state) {
    case SceneState::uploading:
      state_ = State::uploading;
      chunks_held_ = std::min(status.chunks_held, static_cast<std::uint32_t>(chunks.size()));
      // `held` comes with the answer to an offer alone; empty there only where the daemon has nothing.
      if (answer_due_ && (!status.held.empty() || status.chunks_held == 0)) {
        list_missing(status);
      } else if (!status.held.empty()) {
        chunks_lost_ = true;
      }
      break;
    case SceneState::building:
      state_ = State::building;
      answer_due_ = false;
      chunks_held_ = static_cast<std::uint32_t>(chunks.size());
      missing_.clear();
      break;
    case SceneState::ready:
      state_ = State::ready;
      chunks_held_ = static_cast<std::uint32_t>(chunks.size());
      missing_.clear();
      break;
    case SceneState::failed:
      text_ = status.text;
      // To a chunk, not to the offer: the daemon came back without what it had, or forgot it. Over a new
      // connection, so that no more such answers follow.
      if (state_ == State::uploading && chunks_on_link_ > 0 && ++failures_ < k_most_failures) {
        state_ = State::offering;
        offer_due_ = reconnect_due_ = true;
        missing_.clear();
        break;
      }
      state_ = State::failed;
      break;
    case SceneState::full:
      state_ = State::offering;  // mind_silence offers again
      text_ = status.text;
      answer_due_ = false;
      missing_.clear();
      break;
  }
}

void SceneUpload::list_missing(const SceneStatus& status) {
  answer_due_ = chunks_lost_ = false;
  const auto chunk_count = static_cast<std::uint32_t>(scene_->offer.chunk_digests.size());
  VisibleSet held;
  VisibleSetFrame frame;  // a set of numbers like any other
  frame.bitmap = status.held;
  frame.visible_count = status.chunks_held;
  if (!status.held.empty()) {
    auto decoded = decode_visible_set(frame, nullptr, chunk_count);
    if (auto* set = std::get_if<VisibleSet>(&decoded)) held = std::move(*set);
  }
  unsent_ = {};
  missing_.clear();
  for (std::uint32_t i = chunk_count; i-- > 0;) {
    if (!held.contains(ObjectId{i})) missing_.push_back(i);
  }
}

void SceneUpload::on_refusal(const Refusal& refusal) {
  text_ = refusal.text;
  switch (refusal.reason) {
    case RefusalReason::version_mismatch:
    case RefusalReason::scene_mismatch:
      state_ = State::failed;
      return;
    case RefusalReason::malformed:
      // A daemon from before scenes crossed the wire knows no offer.
      if (state_ == State::offering) {
        state_ = State::failed;
        text_ = "daemon takes no scenes: start it with the scene's file, or a newer one (" + text_ + ")";
      }
      return;
    case RefusalReason::no_session:  // a chunk to a daemon that takes none without a session
    case RefusalReason::limit:
    case RefusalReason::shutting_down:
      return;  // silence follows, and another offer
  }
}

UploadProgress SceneUpload::progress() const noexcept {
  const std::uint64_t total = scene_->bytes.size();
  return {std::min<std::uint64_t>(total, std::uint64_t{chunks_held_} * k_scene_chunk_bytes),
          chunk_bytes_sent_, total};
}

}  // namespace sightline
