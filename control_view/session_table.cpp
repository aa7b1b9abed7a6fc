#include "control_view/session_table.hpp"

#include <algorithm>
#include <utility>

namespace sightline {

Session* SessionTable::open(const PeerId& peer, const std::string& client_name, ServedScenePtr scene,
                            const PipelineOptions& options, const Clock& clock, double now_s) {
  if (const Session* earlier = of_peer(peer)) close(*earlier);
  if (sessions_.size() >= capacity_) return nullptr;
  sessions_.push_back(
      std::make_unique<Session>(fresh_id(), peer, client_name, std::move(scene), options, clock, now_s));
  return sessions_.back().get();
}

Session* SessionTable::of_peer(const PeerId& peer) noexcept {
  for (const auto& session : sessions_) {
    if (session->peer() == peer) return session.get();
  }
  return nullptr;
}

void SessionTable::close(const Session& session) {
  const auto same = [&](const auto& held) { return held.get() == &session; };
  const auto found = std::find_if(sessions_.begin(), sessions_.end(), same);
  if (found == sessions_.end()) return;
  const auto index = static_cast<std::size_t>(found - sessions_.begin());
  sessions_.erase(found);
  if (index < turn_) --turn_;
}

std::size_t SessionTable::close_silent(double before_s, double now_s) {
  constexpr double grace_s = 0.25;
  std::size_t closed = 0;
  for (std::size_t i = sessions_.size(); i-- > 0;) {
    if (!sessions_[i]->silent(before_s, now_s, grace_s)) continue;
    close(*sessions_[i]);
    ++closed;
  }
  return closed;
}

Session* SessionTable::next_pending() noexcept {
  for (std::size_t step = 0; step < sessions_.size(); ++step) {
    const std::size_t index = (turn_ + step) % sessions_.size();
    if (!sessions_[index]->has_pending()) continue;
    turn_ = index + 1;
    return sessions_[index].get();
  }
  return nullptr;
}

bool SessionTable::any_pending() const noexcept {
  return std::any_of(sessions_.begin(), sessions_.end(),
                     [](const auto& session) { return session->has_pending(); });
}

std::uint64_t SessionTable::fresh_id() {
  std::uint64_t id = 0;
  while (id == 0) id = (std::uint64_t{random_()} << 32) | random_();
  return id;
}

}  // namespace sightline
