#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/bounds.hpp"

namespace sightline {

/// Where moving objects were foretold to be, to learn from how far they were not there. All objects of one
/// request share its times: a column holds them, and the objects' boxes by slot. The oldest column is written
/// over by the next.
class ForetoldBoxes {
 public:
  struct Column {
    std::uint64_t number = 0;  ///< 0: nothing yet; ascending
    double from_s = 0.0, until_s = 0.0;
    std::vector<WorldBox> boxes;  ///< as extrapolated, not widened
  };

  /// A column for these times, to write the boxes of all moving objects into; null while the newest one is
  /// hardly older. Valid until the next call.
  Column* begin(double now_s, double from_s, double until_s, std::size_t slots) {
    Column& newest = columns_[newest_];
    const bool due = newest.number == 0 || from_s < newest.from_s ||
                     from_s - newest.from_s > (until_s - now_s) / k_columns;
    if (!due) return nullptr;
    newest_ = (newest_ + 1) % k_columns;
    Column& next = columns_[newest_];
    next.number = next_number_++;
    next.from_s = from_s;
    next.until_s = until_s;
    if (next.boxes.size() < slots) next.boxes.resize(slots);
    return &next;
  }

  /// The columns that are about `time_s`, in no order.
  struct Covering {
    std::array<const Column*, 8> columns{};
    std::size_t count = 0;
  };
  /// `being_written` is left out: it says nothing yet. May be null.
  [[nodiscard]] Covering covering(double time_s, const Column* being_written = nullptr) const noexcept {
    Covering found;
    for (const Column& column : columns_) {
      if (&column != being_written && column.number != 0 && column.from_s <= time_s &&
          time_s <= column.until_s)
        found.columns[found.count++] = &column;
    }
    return found;
  }
  /// The number that the next column will have.
  [[nodiscard]] std::uint64_t next_number() const noexcept { return next_number_; }

 private:
  static constexpr std::size_t k_columns = 8;
  std::array<Column, k_columns> columns_;
  std::size_t newest_ = 0;
  std::uint64_t next_number_ = 1;
};

}  // namespace sightline
