#pragma once

#include <vector>

#include "control_view/pixel_sums.hpp"
#include "protocol/visible_set.hpp"

namespace sightline {

/// The objects whose mean is above `threshold_pixels`. At 0 that is every object with any pixel (the exact
/// contract); above 0 the set is aggressive: objects that cover less are left out on purpose.
/// `scratch` is overwritten.
[[nodiscard]] VisibleSet visible_above(const MeanPixels& means, double threshold_pixels,
                                       std::vector<ObjectId>& scratch);

}  // namespace sightline
