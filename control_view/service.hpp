#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "control_view/clock.hpp"
#include "control_view/rate_limit.hpp"
#include "control_view/scene_intake.hpp"
#include "control_view/scene_store.hpp"
#include "control_view/session_table.hpp"
#include "protocol/codec.hpp"
#include "protocol/endpoint_link.hpp"
#include "protocol/messages.hpp"

namespace sightline {

struct ServiceOptions {
  PipelineOptions pipeline;
  std::string engine_name = "item_buffer";
  std::string counter_name;  ///< told to the clients, as is the preset's
  std::string preset_name;
  std::uint32_t max_sessions = 16;
  double heartbeat_interval_s = 1.0;  ///< told to the clients: how often at least to be heard of
  double silence_limit_s = 5.0;       ///< a session not heard of for longer is closed
  double answer_rate_hz = 0.0;  ///< at most so many answers a second, all sessions together; 0: no limit
};

/// Running totals, for logs and tests.
struct ServiceCounters {
  std::uint64_t answered = 0;
  std::uint64_t explained = 0;   ///< questions why that were answered
  std::uint64_t superseded = 0;  ///< requests that a newer one of the same session replaced
  std::uint64_t malformed = 0;   ///< frames that no message could be made of
  std::uint64_t refused = 0;     ///< Refusals sent
  std::uint64_t opened = 0;      ///< sessions
  std::uint64_t reaped = 0;      ///< sessions closed for their silence
  std::uint64_t unsent = 0;      ///< frames whose peer was gone or did not read
};

/// A client's longest frame, bytes: a request that moves every object of the largest scene there can be, the
/// daemon's own or one that is taken in. For the link's limit.
[[nodiscard]] std::size_t largest_frame_of_a_client(std::uint32_t object_count) noexcept;

/// The daemon between its link and its scenes' engines. One thread; `step` is the loop's body.
///
/// A peer's bytes never throw. What leaves step() is a MachineError of the engine, which nobody can serve
/// without.
class Service {
 public:
  /// `intake` may be null: then no scenes are taken over the wire. All must outlive this.
  Service(ServerLink& link, SceneStore& scenes, SceneIntake* intake, ServiceOptions options, Clock clock);

  /// Reads what has come in, waiting for at most `timeout` when there is nothing to do, then answers the
  /// newest request of the session whose turn it is.
  void step(std::chrono::milliseconds timeout);

  /// Tells every session that the daemon goes, and closes it.
  void shut_down();

  [[nodiscard]] const ServiceCounters& counters() const noexcept { return counters_; }
  [[nodiscard]] std::size_t session_count() const noexcept { return sessions_.size(); }

 private:
  /// Returns whether nothing was left unread.
  bool drain(std::chrono::milliseconds timeout);
  void answer(Session& session);
  void answer_request(Session& session, double began_s);
  [[nodiscard]] bool may_answer_now() const;
  [[nodiscard]] std::chrono::milliseconds wait_time(std::chrono::milliseconds timeout) const;

  void receive(const ServerLink::Incoming& incoming);
  void handle(const PeerId& peer, Hello&& hello);
  void handle(const PeerId& peer, ViewRequest&& request);
  void handle(const PeerId& peer, Ping&& ping);
  void handle(const PeerId& peer, Pong&& pong);
  void handle(const PeerId& peer, Goodbye&& goodbye);
  void handle(const PeerId& peer, Why&& question);
  void handle(const PeerId& peer, SceneOffer&& offer);
  void handle(const PeerId& peer, SceneChunk&& chunk);
  void take_chunk(const PeerId& peer, const SceneChunkView& chunk);
  /// Messages that only a daemon sends.
  template <class DaemonMessage>
  void handle(const PeerId& peer, DaemonMessage&& message);

  void refuse(const PeerId& peer, RefusalReason reason, const std::string& text);
  void refuse_malformed(const PeerId& peer, const std::string& why);
  void send(const PeerId& peer, const Message& message);
  void step_intake();
  void log_status(const SceneStatus& status);
  [[nodiscard]] std::uint32_t most_objects() const noexcept;
  [[nodiscard]] std::size_t largest_frame_without_session() const noexcept;

  ServerLink& link_;
  SceneStore& scenes_;
  SceneIntake* intake_;
  ServiceOptions options_;
  Clock clock_;
  SessionTable sessions_;
  DecodeLimits limits_;
  ServiceCounters counters_;
  RateLimit refusal_limit_{1.0};
  RateLimit log_limit_{1.0};
  double next_answer_s_ = 0.0;
};

}  // namespace sightline
