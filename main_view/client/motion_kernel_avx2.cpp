#define SIGHTLINE_LANES avx2
#define SIGHTLINE_LANES_HEADER "main_view/client/motion_lanes_avx2.hpp"
#include "main_view/client/motion_kernel.hpp"

namespace sightline::avx2 {

constinit const MotionFunctions k_motion_functions{&step, &foretell};

}  // namespace sightline::avx2
