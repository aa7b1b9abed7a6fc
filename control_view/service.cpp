#include "control_view/service.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>
#include <variant>

#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "protocol/scene_chunk_frame.hpp"
#include "protocol/scene_chunks.hpp"

namespace sightline {
namespace {

/// What one step reads at most, so that a peer that floods the link cannot keep the others from their
/// answers. The link hands out the peers' frames in turn, so nobody waits behind another's queue either.
constexpr int k_frames_a_step = 256;
constexpr std::size_t k_bytes_a_step = 1u << 20;
constexpr double k_reading_a_step_s = 0.005;

/// How often to look whether a scene is built, while nothing else is to be done.
constexpr std::chrono::milliseconds k_wait_for_builder{1};

/// While a flood leaves frames unread, a silent session may have a word among them: it then gets this many
/// times the silence limit.
constexpr double k_patience_in_a_flood = 10.0;

/// Room for everything but a request's lists of objects: above eight eyes and all texts.
constexpr std::size_t k_frame_without_moves_bytes = 64u << 10;
/// What an object can take on the wire: a move, a box, and whether it is there.
constexpr std::size_t k_object_bytes = 104 + 56 + 8;

}  // namespace

std::size_t largest_frame_of_a_client(std::uint32_t object_count) noexcept {
  return std::min(k_frame_without_moves_bytes + k_object_bytes * object_count,
                  DecodeLimits{}.max_frame_bytes);
}

Service::Service(ServerLink& link, SceneStore& scenes, SceneIntake* intake, ServiceOptions options,
                 Clock clock)
    : link_(link),
      scenes_(scenes),
      intake_(intake),
      options_(std::move(options)),
      clock_(std::move(clock)),
      sessions_(options_.max_sessions) {
  limits_.max_frame_bytes =
      std::max(largest_frame_of_a_client(most_objects()), largest_frame_without_session());
  limits_.max_moves = std::min<std::size_t>(limits_.max_moves, most_objects());
}

std::uint32_t Service::most_objects() const noexcept {
  const std::uint32_t own = scenes_.own() == nullptr ? 0 : scenes_.own()->identity.object_count;
  return intake_ == nullptr ? own : std::max(own, intake_->limits().objects);
}

std::size_t Service::largest_frame_without_session() const noexcept {
  return k_frame_without_moves_bytes + (intake_ == nullptr ? 0 : k_scene_chunk_bytes);
}

void Service::step(std::chrono::milliseconds timeout) {
  const bool all_read = drain(timeout);
  const double patience = all_read ? 1.0 : k_patience_in_a_flood;
  const double now_s = clock_();
  counters_.reaped += sessions_.close_silent(now_s - patience * options_.silence_limit_s, now_s);
  if (intake_ != nullptr) step_intake();
  if (!may_answer_now()) return;
  if (Session* session = sessions_.next_pending()) answer(*session);
}

void Service::step_intake() {
  intake_->step(clock_());
  for (SceneIntake::Notice& notice : intake_->take_notices()) {
    log_status(notice.status);
    send(notice.peer, std::move(notice.status));
  }
}

/// What becomes of scenes, for whoever runs the daemon; progress is the client's to show.
void Service::log_status(const SceneStatus& status) {
  const std::string scene = to_hex(status.scene_digest);
  if (status.state == SceneState::uploading || !log_limit_.take("scene " + scene, clock_())) return;
  if (status.state == SceneState::building)
    spdlog::info("scene {}: {} chunks are there", scene, status.chunk_count);
  if (status.state == SceneState::ready) spdlog::info("scene {} is ready", scene);
  if (status.state == SceneState::failed) spdlog::warn("scene {} not taken: {}", scene, status.text);
  if (status.state == SceneState::full) spdlog::warn("scene {} not taken now: {}", scene, status.text);
}

bool Service::drain(std::chrono::milliseconds timeout) {
  auto incoming = link_.receive(wait_time(timeout));
  const double end_s = clock_() + k_reading_a_step_s;
  std::size_t bytes = 0;
  for (int frames = 1; incoming; ++frames) {
    bytes += incoming->frame.size();
    receive(*incoming);
    if (frames == k_frames_a_step || bytes >= k_bytes_a_step || clock_() >= end_s) return false;
    incoming = link_.receive(std::chrono::milliseconds{0});
  }
  return true;
}

void Service::answer(Session& session) {
  const double began_s = clock_();
  if (options_.answer_rate_hz > 0.0) {
    // Counted from when it was due, or the loop's rounding up would make every interval longer.
    const double period_s = 1.0 / options_.answer_rate_hz;
    const bool long_overdue = began_s - next_answer_s_ > period_s;
    next_answer_s_ = (long_overdue ? began_s : next_answer_s_) + period_s;
  }
  const PeerId peer = session.peer();
  try {
    if (session.has_request()) answer_request(session, began_s);
    if (session.has_question()) {
      send(peer, session.answer_why());
      ++counters_.explained;
    }
  } catch (const MachineError&) {
    throw;  // the engine is lost, and with it every session
  } catch (const std::exception& error) {
    spdlog::error("session closed, its request could not be answered: {}", error.what());
    sessions_.close(session);
    refuse(peer, RefusalReason::limit, "the request could not be answered");
  }
}

void Service::answer_request(Session& session, double began_s) {
  VisibleSetFrame frame = session.answer(began_s);
  const std::uint8_t view = frame.view;
  const double encode_began_s = clock_();
  send(session.peer(), std::move(frame));
  session.note_encode_time(view, clock_() - encode_began_s);
  ++counters_.answered;
}

bool Service::may_answer_now() const {
  return options_.answer_rate_hz <= 0.0 || clock_() >= next_answer_s_;
}

std::chrono::milliseconds Service::wait_time(std::chrono::milliseconds timeout) const {
  if (!sessions_.any_pending())
    return intake_ != nullptr && intake_->is_busy() ? std::min(timeout, k_wait_for_builder) : timeout;
  if (options_.answer_rate_hz <= 0.0) return std::chrono::milliseconds{0};
  const double wait_ms = std::clamp(std::ceil((next_answer_s_ - clock_()) * 1e3), 0.0, 1e6);
  return std::min(timeout, std::chrono::milliseconds{static_cast<std::int64_t>(wait_ms)});
}

void Service::shut_down() {
  while (sessions_.size() > 0) {
    const Session& session = *sessions_.sessions().back();
    refuse(session.peer(), RefusalReason::shutting_down, "the daemon was stopped");
    sessions_.close(session);
  }
}

void Service::receive(const ServerLink::Incoming& incoming) {
  Session* const session = sessions_.of_peer(incoming.peer);
  if (session == nullptr && incoming.frame.size() > largest_frame_without_session()) {
    // Most likely a request with many moves, of a session that was closed.
    if (refusal_limit_.take(incoming.peer, clock_())) {
      refuse(incoming.peer, RefusalReason::no_session, "a large frame without a session: say Hello first");
    }
    return;
  }
  if (const auto chunk = view_scene_chunk(incoming.frame, limits_)) {
    if (session != nullptr) session->heard(clock_());
    return take_chunk(incoming.peer, *chunk);
  }
  auto decoded = decode(incoming.frame, limits_);
  if (const auto* error = std::get_if<DecodeError>(&decoded)) {
    refuse_malformed(incoming.peer, error->reason);
    return;
  }
  if (session != nullptr) session->heard(clock_());
  std::visit([&]<class M>(M&& message) { handle(incoming.peer, std::forward<M>(message)); },
             std::get<Message>(std::move(decoded)));
}

void Service::handle(const PeerId& peer, Hello&& hello) {
  if (hello.version != k_protocol_version) {
    return refuse(peer, RefusalReason::version_mismatch,
                  fmt::format("this daemon speaks version {}, not {}", k_protocol_version, hello.version));
  }
  const ServedScenePtr scene = scenes_.find(hello.scene_digest);
  if (scene == nullptr) {
    const std::string wanted = to_hex(hello.scene_digest);
    return refuse(peer, RefusalReason::scene_mismatch,
                  scenes_.own() == nullptr || intake_ != nullptr
                      ? fmt::format("this daemon has no scene {}{}", wanted,
                                    intake_ == nullptr ? "" : ": offer it, or start the daemon with its file")
                      : fmt::format("this daemon serves scene {}, not {}",
                                    to_hex(scenes_.own()->identity.digest), wanted));
  }
  const Session* session =
      sessions_.open(peer, hello.client_name, scene, options_.pipeline, clock_, clock_());
  if (session == nullptr) {
    return refuse(peer, RefusalReason::limit,
                  fmt::format("all {} sessions of this daemon are taken", sessions_.capacity()));
  }
  ++counters_.opened;
  if (log_limit_.take("opened", clock_())) {
    spdlog::info("session opened ({} of {} in use)", sessions_.size(), sessions_.capacity());
  }

  Welcome welcome;
  welcome.session_id = session->id();
  welcome.server_name = "control_view";
  welcome.engine = options_.engine_name;
  welcome.object_count = scene->identity.object_count;
  welcome.control_size = options_.pipeline.size;
  welcome.filter_length = options_.pipeline.filter_length;
  welcome.heartbeat_interval_s = options_.heartbeat_interval_s;
  welcome.counter = options_.counter_name;
  welcome.threshold = options_.pipeline.threshold_pixels;
  welcome.control_rate_hz = options_.answer_rate_hz;
  welcome.preset = options_.preset_name;
  welcome.refine = options_.pipeline.refine;
  send(peer, welcome);
}

void Service::handle(const PeerId& peer, ViewRequest&& request) {
  Session* session = sessions_.of_peer(peer);
  if (session == nullptr || session->id() != request.session_id) {
    return refuse(peer, RefusalReason::no_session, "no such session of this peer: say Hello first");
  }
  const std::uint32_t object_count = session->scene().identity.object_count;
  const auto all_in_scene = [&](const auto& list) {
    return std::all_of(list.begin(), list.end(),
                       [&](const auto& entry) { return index_of(entry.id) < object_count; });
  };
  if (!all_in_scene(request.moves) || !all_in_scene(request.boxed) || !all_in_scene(request.presence)) {
    return refuse_malformed(peer, "a moved object is not in the scene");
  }
  if (session->accept(std::move(request), clock_())) ++counters_.superseded;
}

void Service::handle(const PeerId& peer, Ping&& ping) {
  send(peer, Pong{ping.nonce, ping.time_s});
}

void Service::handle(const PeerId&, Pong&&) {}

void Service::handle(const PeerId& peer, Goodbye&& goodbye) {
  const Session* session = sessions_.of_peer(peer);
  if (session != nullptr && session->id() == goodbye.session_id) sessions_.close(*session);
}

void Service::handle(const PeerId& peer, Why&& question) {
  Session* session = sessions_.of_peer(peer);
  if (session == nullptr || session->id() != question.session_id) {
    return refuse(peer, RefusalReason::no_session, "no such session of this peer: say Hello first");
  }
  if (index_of(question.object_id) >= session->scene().identity.object_count) {
    return refuse_malformed(peer, "the object asked about is not in the scene");
  }
  (void)session->ask(question, clock_());
}

void Service::handle(const PeerId& peer, SceneOffer&& offer) {
  if (intake_ != nullptr) return intake_->offer(peer, std::move(offer), clock_());
  SceneStatus status;
  status.scene_digest = offer.scene_digest;
  const bool served = scenes_.find(offer.scene_digest) != nullptr;
  status.state = served ? SceneState::ready : SceneState::failed;
  if (!served) status.text = "this daemon takes no scenes over the wire: start it with --uploads on";
  send(peer, status);
}

void Service::handle(const PeerId& peer, SceneChunk&& chunk) {
  take_chunk(peer, chunk);
}

void Service::take_chunk(const PeerId& peer, const SceneChunkView& chunk) {
  if (intake_ != nullptr) return intake_->take(peer, chunk, clock_());
  refuse_malformed(peer, "this daemon takes no scenes over the wire");
}

template <class DaemonMessage>
void Service::handle(const PeerId& peer, DaemonMessage&&) {
  refuse_malformed(peer, "a message that only a daemon sends");
}

void Service::refuse(const PeerId& peer, RefusalReason reason, const std::string& text) {
  ++counters_.refused;
  const SceneDigest own = scenes_.own() == nullptr ? SceneDigest{} : scenes_.own()->identity.digest;
  send(peer, Refusal{reason, text, k_protocol_version, own});
}

void Service::refuse_malformed(const PeerId& peer, const std::string& why) {
  ++counters_.malformed;
  const double now_s = clock_();
  if (log_limit_.take("malformed", now_s)) {
    spdlog::warn("malformed frame: {} ({} so far)", why, counters_.malformed);
  }
  if (refusal_limit_.take(peer, now_s)) refuse(peer, RefusalReason::malformed, why);
}

void Service::send(const PeerId& peer, const Message& message) {
  if (!link_.send(peer, encode(message))) ++counters_.unsent;
}

}  // namespace sightline
