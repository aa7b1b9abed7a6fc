#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

#include "protocol/messages.hpp"
#include "protocol/visible_set.hpp"

namespace sightline {

/// The last few decoded sets of a session's view: what deltas are against, and what may be acknowledged.
class SessionSets {
 public:
  void clear() noexcept { *this = SessionSets(); }

  /// The set that the frame holds; nothing when it is a delta against a set no longer held, does not decode,
  /// or is not newer than all before it. After a failure nothing is acknowledged, so that the daemon sends a
  /// keyframe.
  [[nodiscard]] std::optional<VisibleSet> decode(const VisibleSetFrame& frame, std::uint32_t object_count);

  /// The newest set held, 0 to ask for a keyframe.
  [[nodiscard]] std::uint64_t acked_seq() const noexcept { return keyframe_needed_ ? 0 : newest_seq_; }

 private:
  // Acknowledgements are a round trip behind: room for half a second at 60 answers a second.
  static constexpr std::size_t k_held = 32;

  std::deque<std::pair<std::uint64_t, VisibleSet>> held_;
  std::uint64_t newest_seq_ = 0;
  bool keyframe_needed_ = true;
};

/// Requests of a view that are on their way, so that an answer can be filed with what was asked. Bounded: the
/// oldest goes.
class RequestsInFlight {
 public:
  struct Entry {
    ViewRequest request;
    double issued_s = 0.0;
  };

  void clear() noexcept { entries_.clear(); }
  void add(ViewRequest request, double issued_s);
  /// The request numbered `request_seq`; it and older ones (superseded: newest wins) are forgotten.
  [[nodiscard]] std::optional<Entry> take(std::uint64_t request_seq);
  /// The oldest request that may still be answered.
  [[nodiscard]] std::optional<std::uint64_t> oldest_seq() const noexcept {
    if (entries_.empty()) return {};
    return entries_.front().request.request_seq;
  }

 private:
  static constexpr std::size_t k_held = 256;
  std::deque<Entry> entries_;
};

}  // namespace sightline
