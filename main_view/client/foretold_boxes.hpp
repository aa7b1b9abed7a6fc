#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "main_view/client/motion_block.hpp"

namespace sightline {

/// Where moving objects were foretold to be, to learn from how far they were not there. All objects of one
/// request share its times: a column holds them, and the objects' boxes by blocks of slots. The oldest column
/// is written over by the next.
class ForetoldBoxes {
 public:
  struct Column {
    std::int32_t number = 0;  ///< ascending; wraps after two years of frames
    bool filled = false;
    double from_s = 0.0, until_s = 0.0;
    std::vector<BoxRows> boxes;  ///< as extrapolated, not widened
  };

  /// A column for these times, to write the boxes of all moving objects into; null while the newest one is
  /// hardly older. Valid until the next call.
  Column* begin(double now_s, double from_s, double until_s, std::size_t blocks) {
    Column& newest = columns_[newest_];
    const bool due =
        !newest.filled || from_s < newest.from_s || from_s - newest.from_s > (until_s - now_s) / k_columns;
    if (!due) return nullptr;
    newest_ = (newest_ + 1) % k_columns;
    Column& next = columns_[newest_];
    next.number = next_number_;
    next_number_ = static_cast<std::int32_t>(static_cast<std::uint32_t>(next_number_) + 1u);
    next.filled = true;
    next.from_s = from_s;
    next.until_s = until_s;
    if (next.boxes.size() < blocks) next.boxes.resize(blocks);
    return &next;
  }

  static constexpr std::size_t k_columns = 8;
  static_assert(k_columns <= ForetoldRows::k_most);

  /// The columns that are about one time, in no order.
  struct Covering {
    std::array<const Column*, k_columns> columns{};
    std::size_t count = 0;

    /// One block's part. Blocks that are newer than a column are not in it.
    [[nodiscard]] ForetoldRows rows(std::size_t block) const noexcept {
      ForetoldRows rows;
      for (std::size_t i = 0; i < count; ++i) {
        if (block >= columns[i]->boxes.size()) continue;
        rows.boxes[rows.count] = &columns[i]->boxes[block];
        rows.numbers[rows.count++] = columns[i]->number;
      }
      return rows;
    }
  };
  /// `being_written` is left out: it says nothing yet. May be null.
  [[nodiscard]] Covering covering(double time_s, const Column* being_written = nullptr) const noexcept {
    Covering found;
    for (const Column& column : columns_) {
      if (&column != being_written && column.filled && column.from_s <= time_s && time_s <= column.until_s)
        found.columns[found.count++] = &column;
    }
    return found;
  }
  /// The number that the next column will have.
  [[nodiscard]] std::int32_t next_number() const noexcept { return next_number_; }

 private:
  std::array<Column, k_columns> columns_;
  std::size_t newest_ = 0;
  std::int32_t next_number_ = 1;
};

}  // namespace sightline
