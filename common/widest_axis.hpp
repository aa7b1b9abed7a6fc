#pragma once

#include <glm/vec3.hpp>

namespace sightline {

/// The axis along which to cut: 0, 1 or 2, the first of equals.
[[nodiscard]] inline int widest_axis(const glm::vec3& extent) noexcept {
  int axis = 0;
  if (extent.y > extent[axis]) axis = 1;
  if (extent.z > extent[axis]) axis = 2;
  return axis;
}

}  // namespace sightline
