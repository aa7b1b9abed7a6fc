#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

#include "protocol/visible_set.hpp"

namespace sightline {

/// The sets a session was sent lately, by number, so that the next can be sent as the difference from the one
/// its client holds.
class SentSets {
 public:
  /// Half a second of answers at 60 Hz: a client whose acknowledgement is older gets a keyframe.
  static constexpr std::size_t k_capacity = 32;

  /// Files a set under the next number, 1, 2, 3 ..., and returns that. The oldest makes room.
  std::uint64_t add(VisibleSet set);
  /// The set of that number, or null when it never was or is no longer held.
  [[nodiscard]] const VisibleSet* find(std::uint64_t set_seq) const noexcept;
  /// Forgets the sets older than the acknowledged one: a client never goes back.
  void acknowledge(std::uint64_t set_seq);
  [[nodiscard]] std::size_t size() const noexcept { return sets_.size(); }

 private:
  std::deque<VisibleSet> sets_;
  std::uint64_t first_seq_ = 1;  ///< of sets_.front()
};

}  // namespace sightline
