#define SIGHTLINE_LANES avx2
#include "control_view/engines/raster/kernel_functions.hpp"

namespace sightline::raster::avx2 {

constinit const KernelFunctions k_functions = functions_of_these_lanes();

}  // namespace sightline::raster::avx2
