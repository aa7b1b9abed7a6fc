#define SIGHTLINE_LANES sse41
#include "control_view/engines/raster/draw_region.hpp"
