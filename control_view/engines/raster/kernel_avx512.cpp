#define SIGHTLINE_LANES avx512
#include "control_view/engines/raster/draw_region.hpp"

namespace sightline::raster::avx512 {

RegionResult draw_region(const RegionJob& job, RegionMemory& memory) {
  return RegionDrawer(job, memory).draw();
}

}  // namespace sightline::raster::avx512
