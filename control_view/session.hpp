#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "control_view/apply_moves.hpp"
#include "control_view/sent_sets.hpp"
#include "control_view/visibility_pipeline.hpp"
#include "protocol/endpoint_link.hpp"
#include "protocol/messages.hpp"

namespace sightline {

/// A request that waits for its turn.
struct PendingRequest {
  ViewRequest request;
  double received_s = 0.0;
};

/// Everything the daemon keeps for one client. Sessions share the scene and the engine and nothing else.
class Session {
 public:
  Session(std::uint64_t id, PeerId peer, std::string client_name, VisibilityPipeline pipeline, double now_s);

  /// Takes a request in: its moves are applied at once, and it replaces one that still waits. What must not
  /// be lost with the one replaced (a reset of the filter) passes on. An object that jumps, appears or
  /// vanishes resets the filter too where that could keep out what now shows. One that is older than the
  /// newest heard of counts as superseded itself and changes nothing. Returns whether a request was
  /// superseded.
  bool accept(ViewRequest request, double now_s);
  [[nodiscard]] bool has_pending() const noexcept { return pending_.has_value(); }

  /// Answers the pending request. Requires has_pending().
  [[nodiscard]] VisibleSetFrame answer(VisibilityEngine& engine, const SceneDigest& digest, double now_s);
  void note_encode_time(double encode_s) noexcept { last_encode_s_ = encode_s; }

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

 private:
  PeerId peer_;
  std::string client_name_;
  VisibilityPipeline pipeline_;
  SceneEdits edits_;
  SentSets sent_;
  std::optional<PendingRequest> pending_;
  std::uint64_t newest_request_seq_ = 0;
  double last_heard_s_ = 0.0;
  std::optional<double> missed_since_s_;  ///< when its silence was first found
  double last_encode_s_ = 0.0;
};

}  // namespace sightline
