#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "protocol/messages.hpp"

namespace sightline {

/// Why a view shows an object or does not, in pixels of the object: those where it would show if it were
/// alone in the view, its blended parts taken as opaque. shown_px and the pixels of `hidden_by`, before it is
/// cut to k_max_blockers, add up to alone_px.
struct Explanation {
  bool known = false;     ///< whether the engine can say; what follows is empty otherwise
  bool in_field = false;  ///< whether any of it may reach into the field of any eye; errs towards true
  /// Image pixels were so much smaller each way than the query's: its first size, 1, had none of the object.
  std::uint32_t scale = 1;
  std::uint64_t alone_px = 0;  ///< 0: it faces away everywhere, or falls between the samples
  std::uint64_t shown_px = 0;
  std::vector<Blocker> hidden_by;  ///< owners of the others, most pixels first, then by id
};

/// Puts blockers into the order of an Explanation, and keeps k_max_blockers of them.
inline void keep_most(std::vector<Blocker>& blockers) {
  std::sort(blockers.begin(), blockers.end(), [](const Blocker& a, const Blocker& b) {
    return a.pixels != b.pixels ? a.pixels > b.pixels : a.id < b.id;
  });
  if (blockers.size() > k_max_blockers) blockers.resize(k_max_blockers);
}

}  // namespace sightline
