#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "control_view/apply_moves.hpp"
#include "control_view/served_scene.hpp"
#include "control_view/session_view.hpp"
#include "control_view/why_queue.hpp"
#include "protocol/endpoint_link.hpp"
#include "protocol/messages.hpp"

namespace sightline {

/// Everything the daemon keeps for one client. Sessions share the scene and the engine and nothing else.
class Session {
 public:
  Session(std::uint64_t id, PeerId peer, std::string client_name, ServedScenePtr scene,
          const PipelineOptions& options, Clock clock, double now_s);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Takes a request in: its moves and changes of presence are applied at once, for all views, and it
  /// replaces one of its view that still waits. An object that jumps, appears or vanishes resets the filters
  /// where they could keep out what now shows. Returns whether a request was superseded.
  bool accept(ViewRequest request, double now_s);
  /// Takes in a question why; whether there was room for it, see WhyQueue.
  bool ask(const Why& question, double now_s) { return questions_.add(question, now_s); }
  [[nodiscard]] bool has_request() const noexcept;
  [[nodiscard]] bool has_question() const noexcept { return !questions_.empty(); }
  /// Whether either waits for the session's turn.
  [[nodiscard]] bool has_pending() const noexcept { return has_question() || has_request(); }

  /// Answers the request of the view that waits longest. Requires has_request().
  [[nodiscard]] VisibleSetFrame answer(double now_s);
  /// Answers the oldest question. Requires has_question(), and its object to be of the scene.
  [[nodiscard]] WhyAnswer answer_why();
  /// How long it took to write the last answer of that view.
  void note_encode_time(std::uint8_t view, double encode_s) noexcept;

  void heard(double now_s) noexcept {
    last_heard_s_ = now_s;
    missed_since_s_.reset();
  }
  /// Whether nothing was heard since `before_s`, and still not for `grace_s` after that was first found. The
  /// grace is for words on their way: a daemon that was itself away (a long draw, a suspended machine) finds
  /// every session silent at once, the living too.
  [[nodiscard]] bool silent(double before_s, double now_s, double grace_s) noexcept;
  [[nodiscard]] std::uint64_t id() const noexcept { return edits_.owner; }
  [[nodiscard]] const PeerId& peer() const noexcept { return peer_; }
  [[nodiscard]] const std::string& client_name() const noexcept { return client_name_; }
  [[nodiscard]] ServedScene& scene() const noexcept { return *scene_; }
  [[nodiscard]] const SceneEdits& edits() const noexcept { return edits_; }
  /// Null for a view that nothing was asked of.
  [[nodiscard]] const SessionView* view(std::uint8_t view) const noexcept { return views_[view].get(); }

 private:
  PeerId peer_;
  std::string client_name_;
  ServedScenePtr scene_;
  PipelineOptions options_;
  Clock clock_;
  SceneEdits edits_;
  std::array<std::unique_ptr<SessionView>, k_max_views> views_;
  WhyQueue questions_;
  double last_heard_s_ = 0.0;
  std::optional<double> missed_since_s_;  ///< when its silence was first found
};

}  // namespace sightline
