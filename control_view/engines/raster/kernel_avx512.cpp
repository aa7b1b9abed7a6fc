#define SIGHTLINE_LANES avx512
#include "control_view/engines/raster/kernel_functions.hpp"

namespace sightline::raster::avx512 {

constinit const KernelFunctions k_functions = functions_of_these_lanes();

}  // namespace sightline::raster::avx512
