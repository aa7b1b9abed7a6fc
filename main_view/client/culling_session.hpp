#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "main_view/client/culling_core.hpp"
#include "protocol/endpoint_link.hpp"

namespace sightline {

struct SessionOptions {
  std::string endpoint;
  std::string client_name = "main_view";
  SceneDigest scene_digest{};
  std::uint32_t object_count = 0;
  LinkOptions link;
  double reconnect_interval_s = 0.25;  ///< between Hellos while no daemon answers
  double silence_limit_s = 1.0;        ///< no frame for this long: the session is lost
};

enum class SessionState { connecting, open, refused };

/// An answer that has arrived and been turned back into a set.
struct Answer {
  ViewRequest request;
  double issued_s = 0.0;
  VisibleSet set;
  VisibleSetFrame frame;  ///< bitmap left empty; times and counts as sent
};

/// The session with one daemon: handshake, heartbeat, reconnect, deltas against the last acknowledged set,
/// for each view by itself. Never blocks except in wait, wait_for and wait_until_open. A refused session
/// (other version, other scene, a reason only a newer daemon has) stays refused and says why. A daemon that
/// is full (RefusalReason::limit) is asked again, four reconnect_interval_s apart: the session stays
/// connecting meanwhile, and says why.
class CullingSession {
 public:
  explicit CullingSession(SessionOptions options);
  ~CullingSession();

  /// Reads what has arrived, answers pings, says Hello when due. Call once a frame.
  /// Returns the answers that arrived, oldest first. A frame that does not decode is counted and dropped.
  std::vector<Answer> poll(double now_s);

  /// Sends a request of any of the session's views (fills in session_id and acked_set_seq). Does nothing
  /// unless open. `now_s` comes back as the answer's issued_s and may be of another clock than poll's.
  bool send(ViewRequest request, double now_s);
  /// Asks why; false unless open. The answers come from take_why_answers after a poll.
  bool send_why(std::uint64_t nonce, std::uint8_t view, ObjectId id);
  [[nodiscard]] std::vector<WhyAnswer> take_why_answers();

  /// Blocks until the answer to `request_seq` of a view has arrived or `timeout_s` passed. For audits and
  /// tests.
  [[nodiscard]] std::optional<Answer> wait_for(std::uint64_t request_seq, double timeout_s,
                                               std::uint8_t view = 0);
  /// Blocks until anything has arrived or `timeout_s` passed; the next poll files it.
  void wait(double timeout_s);
  /// Blocks until the session is open or refused, or `timeout_s` passed.
  SessionState wait_until_open(double timeout_s);
  /// Says Hello again with the next poll, though refused: the daemon has got the scene meanwhile.
  void retry();

  [[nodiscard]] SessionState state() const noexcept;
  /// The daemon's Welcome, while open.
  [[nodiscard]] const std::optional<Welcome>& welcome() const noexcept;
  /// Why the session was refused, while refused; or, while connecting, what a full daemon said last.
  [[nodiscard]] const std::optional<Refusal>& refusal() const noexcept;
  /// Number of the oldest request of a view that an answer may still come to; empty when none can.
  [[nodiscard]] std::optional<std::uint64_t> oldest_in_flight(std::uint8_t view) const noexcept;
  /// Goes up each time an open session is lost: the caller then forgets its sets.
  [[nodiscard]] std::uint64_t lost_count() const noexcept;
  [[nodiscard]] std::uint64_t bytes_sent() const noexcept;
  [[nodiscard]] std::uint64_t bytes_received() const noexcept;
  [[nodiscard]] std::uint64_t bad_frame_count() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
