#define SIGHTLINE_LANES avx512
#include "control_view/engines/raster/kernel_functions.hpp"
