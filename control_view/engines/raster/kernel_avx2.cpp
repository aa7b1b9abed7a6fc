#define SIGHTLINE_LANES avx2
#include "control_view/engines/raster/draw_region.hpp"

namespace sightline::raster::avx2 {

RegionResult draw_region(const RegionJob& job, RegionMemory& memory) {
  return RegionDrawer(job, memory).draw();
}

}  // namespace sightline::raster::avx2
