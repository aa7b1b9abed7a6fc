#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "common/view.hpp"
#include "protocol/messages.hpp"

namespace sightline {

/// What a view's looks so far say of one object. No look is made for it.
struct ObjectStanding {
  /// visible, below_threshold, held_by_filter, open or boxed; nothing for one that is in no set and was not
  /// seen: why, only the engine can say.
  std::optional<WhyState> state;
  std::uint32_t pixels = 0;  ///< in the last look; of the control image
  double pixels_mean = 0.0;  ///< over the answers that the filter holds
  double threshold = 0.0;
};

/// Where a view's last whole look went, to look there again.
struct LookedAt {
  std::uint64_t request_seq = 0;  ///< the newest answered; 0: none yet
  std::span<const Eye> eyes;      ///< widened
  ImageSize size;
};

}  // namespace sightline
