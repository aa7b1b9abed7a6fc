#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "main_view/client/field_coverage.hpp"
#include "main_view/client/seen_set.hpp"
#include "protocol/messages.hpp"
#include "protocol/visible_set.hpp"

namespace sightline {

/// A visible set and the request that it answers, which says for which time, from where, and how far it
/// looked.
struct FiledSet {
  ViewRequest request;
  VisibleSet set;
  // Made ready by the timeline:
  SeenSet seen{};                   ///< the set
  std::vector<TestedEye> tested{};  ///< the request's eyes
};

/// The visible sets at hand, each under the time it is FOR (not when it arrived), oldest first. Client's
/// clock.
class VisibleSetTimeline {
 public:
  /// Keeps at most `capacity` sets: the oldest goes first.
  explicit VisibleSetTimeline(std::size_t capacity = 64) : capacity_(capacity) {}

  /// Of two sets for the same time the one with the newer request stays.
  void file(ViewRequest request, VisibleSet set);

  /// Forgets the sets for times before `time_s`.
  void drop_before(double time_s);
  void clear() noexcept { sets_.clear(); }
  /// Memory for as many boxes as a request that was forgotten had; empty.
  [[nodiscard]] std::vector<BoxedObject> take_spare_boxes() noexcept {
    return std::exchange(spare_boxes_, {});
  }

  /// S_last and S_next: the nearest set for a time at or before `now_s`, and after it. Null where there is
  /// none. Valid until the timeline changes.
  [[nodiscard]] const FiledSet* last_at_or_before(double now_s) const noexcept;
  [[nodiscard]] const FiledSet* next_after(double now_s) const noexcept;
  /// S_next and every set for a later time, nearest first. Valid until the timeline changes.
  [[nodiscard]] std::span<const FiledSet> all_after(double now_s) const noexcept;
  /// The lowest request number of the sets held for times from `from_s` on; empty without any.
  [[nodiscard]] std::optional<std::uint64_t> lowest_request_seq(double from_s) const noexcept;
  [[nodiscard]] std::size_t size() const noexcept { return sets_.size(); }

 private:
  std::size_t capacity_;
  void keep_boxes(FiledSet& forgotten) noexcept;

  std::vector<FiledSet> sets_;
  std::vector<BoxedObject> spare_boxes_;
};

}  // namespace sightline
