#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "control_view/session.hpp"

namespace sightline {

/// The open sessions, at most one a peer, and whose turn it is.
class SessionTable {
 public:
  explicit SessionTable(std::size_t capacity) : capacity_(capacity) {}

  /// Opens a session under a fresh random id, in the place of the peer's earlier one. Null when the table is
  /// full.
  Session* open(const PeerId& peer, const std::string& client_name, ServedScenePtr scene,
                const PipelineOptions& options, const Clock& clock, double now_s);
  /// The peer's session, or null.
  [[nodiscard]] Session* of_peer(const PeerId& peer) noexcept;
  void close(const Session& session);

  /// Closes the sessions not heard of since `before_s` and for a short grace besides (see Session::silent);
  /// returns how many.
  std::size_t close_silent(double before_s, double now_s);

  /// The next session that has a request pending, in turn; null when none has.
  [[nodiscard]] Session* next_pending() noexcept;
  [[nodiscard]] bool any_pending() const noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return sessions_.size(); }
  [[nodiscard]] std::size_t capacity() const noexcept { return capacity_; }
  [[nodiscard]] const std::vector<std::unique_ptr<Session>>& sessions() const noexcept { return sessions_; }

 private:
  [[nodiscard]] std::uint64_t fresh_id();

  std::size_t capacity_;
  std::vector<std::unique_ptr<Session>> sessions_;
  std::size_t turn_ = 0;  ///< index of the session that is asked first
  std::random_device random_;
};

}  // namespace sightline
