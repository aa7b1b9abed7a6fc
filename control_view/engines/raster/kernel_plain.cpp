#define SIGHTLINE_LANES plain
#include "control_view/engines/raster/kernel_functions.hpp"
