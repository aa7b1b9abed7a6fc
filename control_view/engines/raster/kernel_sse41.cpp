#define SIGHTLINE_LANES sse41
#include "control_view/engines/raster/kernel_functions.hpp"
