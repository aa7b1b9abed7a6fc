#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/object_id.hpp"
#include "protocol/messages.hpp"

namespace sightline {

/// For each view of a client a request number.
using RequestNumbers = std::array<std::uint64_t, k_max_views>;

/// The ids that objects can be added under. One whose object was removed is given out again only when no
/// answer that may speak of the old object can still come, and no set at hand is from before.
class ObjectIds {
 public:
  /// Spare ids from `first` on.
  ObjectIds(std::uint32_t first, std::uint32_t count);

  /// Empty when none is free.
  [[nodiscard]] std::optional<ObjectId> take();
  /// The object left; requests from `next` on, of each view, know of it.
  void retire(ObjectId id, const RequestNumbers& next);
  /// `oldest`: of each view the lowest number among the requests that may still be answered and the sets at
  /// hand; the largest value where there is none.
  void release(const RequestNumbers& oldest);

  [[nodiscard]] std::uint32_t free_count() const noexcept {
    return fresh_end_ - fresh_ + static_cast<std::uint32_t>(free_.size());
  }
  [[nodiscard]] std::size_t quarantined_count() const noexcept { return quarantine_.size(); }

 private:
  struct Retired {
    ObjectId id{};
    RequestNumbers next{};
  };

  std::uint32_t fresh_;  ///< never given out: from here to the end
  std::uint32_t fresh_end_;
  std::vector<ObjectId> free_;
  std::deque<Retired> quarantine_;
};

}  // namespace sightline
