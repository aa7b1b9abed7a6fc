#define SIGHTLINE_LANES plain
#define SIGHTLINE_LANES_HEADER "main_view/client/motion_lanes_plain.hpp"
#include "main_view/client/motion_kernel.hpp"

namespace sightline::plain {

constinit const MotionFunctions k_motion_functions{&step, &foretell};

}  // namespace sightline::plain
