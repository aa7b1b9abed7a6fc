#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "control_view/engines/raster/kernel.hpp"

namespace sightline::raster {

/// How much finer a closer look samples, each way.
inline constexpr std::int32_t k_closeup_scale = 4;
/// An object open in more blocks than this stays open without a closer look.
inline constexpr int k_closeup_blocks = 6;
/// Blocks that closer looks may take of one view: what a crowded horizon may cost.
inline constexpr std::size_t k_most_closeup_blocks = 160;

/// A wider part shares the way to its boxes among more blocks, and holds more that nobody asks about.
inline constexpr std::int32_t k_longest_closeup_blocks = 8;
inline constexpr std::uint32_t k_longest_closeup_px =
    k_block * (k_closeup_scale * k_longest_closeup_blocks + 2);
inline constexpr std::uint32_t k_highest_closeup_px = k_block * (k_closeup_scale + 2);

/// A part of a view that is drawn again, k_closeup_scale times as fine, for the few objects left open in it.
struct Closeup {
  const KernelScene* scene = nullptr;
  const RasterView* view = nullptr;  ///< of the fine image
  RasterRegion region;               ///< of the fine image, a rim of one block on every side included
  ErosionRadius radius;              ///< in pixels of the fine image
  bool both_sides = false;           ///< see ProbeJob
  std::vector<std::uint32_t> candidates;
};

/// An object left open, and the blocks of the view that hold all of where it is.
struct OpenSpot {
  std::uint32_t object = 0;
  std::int32_t left = 0, bottom = 0, right = 0, top = 0;  ///< blocks, ends included
};

/// Rows of neighbouring blocks that cover the spots, as many as k_most_closeup_blocks allow; `uncovered`
/// receives the objects of spots that did not fit. Regions and candidates are filled in, the rest is not.
[[nodiscard]] std::vector<Closeup> closeups_of(std::span<const OpenSpot> spots, std::int32_t blocks_x,
                                               std::int32_t blocks_y, std::vector<std::uint32_t>& uncovered);

}  // namespace sightline::raster
