#define SIGHTLINE_LANES plain
#include "control_view/engines/raster/kernel_functions.hpp"

namespace sightline::raster::plain {

constinit const KernelFunctions k_functions = functions_of_these_lanes();

}  // namespace sightline::raster::plain
