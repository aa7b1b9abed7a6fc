// Included by one file for each instruction set, which defines SIGHTLINE_LANES as its namespace.
#pragma once

#include "control_view/engines/raster/draw_region.hpp"
#include "control_view/engines/raster/needle_test.hpp"
#include "control_view/engines/raster/probe_region.hpp"

namespace sightline::raster::SIGHTLINE_LANES {

inline RegionResult draw_region(const RegionJob& job, RegionMemory& memory) {
  return RegionDrawer(job, memory).draw();
}

inline RegionResult probe_region(const ProbeJob& job, RegionMemory& memory) {
  return RegionProber(job, memory).probe();
}

constexpr KernelFunctions functions_of_these_lanes() {
  return {draw_region, copy_depth, probe_region, find_needles};
}

}  // namespace sightline::raster::SIGHTLINE_LANES
