#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "main_view/client/scene_description.hpp"
#include "protocol/endpoint_link.hpp"

namespace sightline {

struct UploadProgress {
  std::uint64_t bytes_held = 0;  ///< that the daemon has said it has
  std::uint64_t bytes_sent = 0;  ///< by this client, again after a reconnect where it had to
  std::uint64_t bytes_total = 0;
};

/// Gives a daemon a scene: offers it, sends the chunks it lacks as fast as the link takes them, and offers
/// again when the daemon falls silent, forgets, or comes back, so that only what is missing goes twice.
///
/// Has a link of its own, so that a session's frames never wait behind megabytes. Never blocks but in wait.
class SceneUpload {
 public:
  enum class State {
    offering,   ///< nobody has answered, or the daemon is full of other scenes
    uploading,  ///< chunks are missing
    building,   ///< the daemon has all
    ready,
    failed  ///< the daemon will not have it: text() says why
  };

  /// Throws InputError for an endpoint that is none. `retry_interval_s`: between offers while nobody answers.
  SceneUpload(const std::string& endpoint, const LinkOptions& link, std::shared_ptr<const PackedScene> scene,
              double retry_interval_s);

  /// Reads what has come and sends what goes. `now_s`: of any clock that runs in real time.
  State poll(double now_s);
  /// Blocks until something has come or `timeout_s` passed; the next poll files it.
  void wait(double timeout_s);

  [[nodiscard]] State state() const noexcept { return state_; }
  /// What the daemon said last about why not; may be empty.
  [[nodiscard]] const std::string& text() const noexcept { return text_; }
  [[nodiscard]] UploadProgress progress() const noexcept;
  [[nodiscard]] std::uint64_t bytes_sent() const noexcept { return link_.bytes_sent(); }
  [[nodiscard]] std::uint64_t bytes_received() const noexcept { return link_.bytes_received(); }

 private:
  void offer(double now_s, bool anew);
  void take_frame(const Bytes& frame);
  void on_status(const SceneStatus& status);
  void on_refusal(const Refusal& refusal);
  void list_missing(const SceneStatus& status);
  void send_chunks(double now_s);
  void mind_silence(double now_s);

  LinkOptions options_;
  ClientLink link_;
  /// Shared with whoever else uploads the scene: tens of megabytes that never change.
  std::shared_ptr<const PackedScene> scene_;
  double retry_interval_s_;
  State state_ = State::offering;
  std::string text_;
  std::vector<std::uint32_t> missing_;  ///< chunks still to send, last one first
  Frame unsent_;                        ///< the next one's frame, when the link would not take it
  std::uint32_t chunks_held_ = 0;
  std::uint64_t chunk_bytes_sent_ = 0;
  bool answer_due_ = false;   ///< to the newest offer
  bool chunks_lost_ = false;  ///< some that the daemon had, or that others sent, were wrong
  bool offer_due_ = true;
  bool reconnect_due_ = false;        ///< before the next offer
  std::uint64_t chunks_on_link_ = 0;  ///< since it was connected
  bool polled_ = false;
  bool heard_ = false;     ///< something since the last mind_silence
  double lively_s_ = 0.0;  ///< when something was last heard or sent
  double offered_s_ = 0.0;
  double backoff_ = 1.0;
  int failures_ = 0;  ///< in the middle of an upload
};

}  // namespace sightline
