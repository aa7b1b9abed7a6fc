#pragma once

#include <vector>

#include "main_view/client/told_history.hpp"
#include "protocol/messages.hpp"

namespace sightline {

/// A shadow to be: of the place that an object was told to rest at, for viewpoints near one eye.
struct ShadowToBe {
  const Told* told = nullptr;
  const Eye* eye = nullptr;
  double slack_m = 0.0;
};

/// Eyes no further apart share a shadow, metres: a little larger, and asked about once.
inline constexpr double k_shared_shadow_m = 0.3;

/// Adds the shadows that a resting object cast in the answer to a request. `shadows` are the same object's.
void cast_shadows(const Told& told, const ViewRequest& request, std::vector<ShadowToBe>& shadows);

}  // namespace sightline
