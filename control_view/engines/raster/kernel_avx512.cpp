#define SIGHTLINE_LANES avx512
#include "control_view/engines/raster/draw_region.hpp"
