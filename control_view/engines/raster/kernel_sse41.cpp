#define SIGHTLINE_LANES sse41
#include "control_view/engines/raster/draw_region.hpp"

namespace sightline::raster::sse41 {

RegionResult draw_region(const RegionJob& job, RegionMemory& memory) {
  return RegionDrawer(job, memory).draw();
}

}  // namespace sightline::raster::sse41
