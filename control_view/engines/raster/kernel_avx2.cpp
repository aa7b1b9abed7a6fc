#define SIGHTLINE_LANES avx2
#include "control_view/engines/raster/kernel_functions.hpp"
