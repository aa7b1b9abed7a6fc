#pragma once

#include "common/pose.hpp"

namespace sightline {

/// A pose that is expected, and how far off it may be.
struct PredictedPose {
  Pose pose;
  double position_error_m = 0.0;
  double rotation_error_rad = 0.0;
};

}  // namespace sightline
