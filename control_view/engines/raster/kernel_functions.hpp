// Included by one file for each instruction set, which defines SIGHTLINE_LANES as its namespace.
#pragma once

#include "control_view/engines/raster/draw_region.hpp"
#include "control_view/engines/raster/probe_region.hpp"

namespace sightline::raster::SIGHTLINE_LANES {

const KernelFunctions k_functions{
    [](const RegionJob& job, RegionMemory& memory) { return RegionDrawer(job, memory).draw(); },
    copy_depth,
    [](const ProbeJob& job, RegionMemory& memory) { return RegionProber(job, memory).probe(); },
};

}  // namespace sightline::raster::SIGHTLINE_LANES
