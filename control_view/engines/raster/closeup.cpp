#include "control_view/engines/raster/closeup.hpp"

#include <algorithm>

namespace sightline::raster {
std::vector<Closeup> closeups_of(std::span<const OpenSpot> spots, std::int32_t blocks_x,
                                 std::int32_t blocks_y, std::vector<std::uint32_t>& uncovered) {
  std::vector<std::uint8_t> wanted(static_cast<std::size_t>(blocks_x) * static_cast<std::size_t>(blocks_y),
                                   0);
  const auto at = [&](std::int32_t bx, std::int32_t by) -> std::uint8_t& {
    return wanted[static_cast<std::size_t>(by * blocks_x + bx)];
  };
  std::size_t taken = 0;
  std::vector<OpenSpot> covered;
  for (const OpenSpot& spot : spots) {
    std::size_t more = 0;
    for (std::int32_t by = spot.bottom; by <= spot.top; ++by) {
      for (std::int32_t bx = spot.left; bx <= spot.right; ++bx) more += at(bx, by) == 0 ? 1 : 0;
    }
    if (taken + more > k_most_closeup_blocks) {
      uncovered.push_back(spot.object);
      continue;
    }
    taken += more;
    for (std::int32_t by = spot.bottom; by <= spot.top; ++by) {
      for (std::int32_t bx = spot.left; bx <= spot.right; ++bx) at(bx, by) = 1;
    }
    covered.push_back(spot);
  }

  std::vector<Closeup> closeups;
  const std::int32_t fine_block = k_block * k_closeup_scale;
  for (std::int32_t by = 0; by < blocks_y; ++by) {
    for (std::int32_t bx = 0; bx < blocks_x; ++bx) {
      if (at(bx, by) == 0) continue;
      std::int32_t end = bx + 1;
      while (end < blocks_x && end - bx < k_longest_closeup_blocks && at(end, by) != 0) ++end;
      Closeup closeup;
      closeup.region = {bx * fine_block - k_block, by * fine_block - k_block,
                        (end - bx) * fine_block + 2 * k_block, fine_block + 2 * k_block};
      for (const OpenSpot& spot : covered) {
        const bool here = spot.bottom <= by && spot.top >= by && spot.left < end && spot.right >= bx;
        if (here) closeup.candidates.push_back(spot.object);
      }
      closeups.push_back(std::move(closeup));
      bx = end - 1;
    }
  }
  return closeups;
}

}  // namespace sightline::raster
