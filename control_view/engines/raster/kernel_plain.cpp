#define SIGHTLINE_LANES plain
#include "control_view/engines/raster/draw_region.hpp"
