#define SIGHTLINE_LANES sse41
#include "control_view/engines/raster/kernel_functions.hpp"

namespace sightline::raster::sse41 {

constinit const KernelFunctions k_functions = functions_of_these_lanes();

}  // namespace sightline::raster::sse41
