#define SIGHTLINE_LANES plain
#include "control_view/engines/raster/draw_region.hpp"

namespace sightline::raster::plain {

RegionResult draw_region(const RegionJob& job, RegionMemory& memory) {
  return RegionDrawer(job, memory).draw();
}

}  // namespace sightline::raster::plain
