#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include <glm/mat4x3.hpp>

#include "common/bounds.hpp"
#include "protocol/messages.hpp"

namespace sightline {

/// What an object is to the daemon.
enum class ObjectState : std::uint8_t {
  unknown,  ///< where the file has it, wherever that is
  resting,
  moving,  ///< boxed
  absent
};

/// No request says so.
inline constexpr std::uint64_t k_never_told = std::numeric_limits<std::uint64_t>::max();

/// What requests from `first_seq` on say of an object, until the next such entry.
struct Told {
  std::uint64_t first_seq = 0;
  double time_s = 0.0;
  ObjectState state = ObjectState::unknown;
  glm::dmat4x3 world_from_object{1.0};  ///< resting
  WorldBox bounds;                      ///< resting
};

/// Entries by ascending first_seq. Only changes are kept, so a thing that goes on as it did adds nothing.
class ToldHistory {
 public:
  void add(const Told& now) {
    const bool same = !entries_.empty() && entries_.back().state == now.state &&
                      entries_.back().world_from_object == now.world_from_object;
    if (!same) entries_.push_back(now);
  }
  /// Forgets what no request since `time_s` says.
  void forget_before(double time_s) {
    while (entries_.size() > 1 && entries_[1].time_s < time_s) entries_.erase(entries_.begin());
  }
  void clear() noexcept { entries_.clear(); }

  /// What request `seq` said; null for one from before the object was heard of.
  [[nodiscard]] const Told* at(std::uint64_t seq) const noexcept {
    const Told* found = nullptr;
    for (const Told& told : entries_) {
      if (told.first_seq > seq) break;
      found = &told;
    }
    return found;
  }
  [[nodiscard]] const Told& newest() const noexcept { return entries_.back(); }
  [[nodiscard]] bool empty() const noexcept { return entries_.empty(); }
  /// Whether all requests that may be answered say the same.
  [[nodiscard]] bool is_settled() const noexcept { return entries_.size() == 1; }

 private:
  std::vector<Told> entries_;
};

/// A message that is repeated until a request that carried it is answered.
struct Delivery {
  bool due = false;
  std::uint64_t first_seq = 0;  ///< 0: not sent yet

  void begin() noexcept { *this = {true, 0}; }
  void send(std::uint64_t seq) noexcept {
    if (first_seq == 0) first_seq = seq;
  }
  void acknowledge(std::uint64_t seq) noexcept {
    if (first_seq != 0 && seq >= first_seq) due = false;
  }
  [[nodiscard]] bool is_under_way() const noexcept { return due && first_seq != 0; }
};

}  // namespace sightline
