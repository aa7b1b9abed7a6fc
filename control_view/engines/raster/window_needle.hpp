#pragma once

#include <glm/vec2.hpp>

#include "control_view/engines/raster/kernel.hpp"

namespace sightline::raster {

/// A needle in the window, as OpenGL has it: pixels from the lower left corner of the image, reversed depth.
struct WindowNeedle {
  glm::vec2 at[3];
  float depth[3];
};

/// Whether the line between those two corners that lie farthest apart passes within `reach` of the centre of
/// a pixel of the part.
[[nodiscard]] bool meets_a_centre(const WindowNeedle& needle, float reach, const RasterRegion& part);

/// Whether OpenGL's depth of a needle, within `reach` of it, may be nearer than bounds allow for. Its plane
/// goes through the first corner, or the second where it is turned (see set_up), and through the others only
/// as far as the needle's area is right.
[[nodiscard]] bool goes_astray(const WindowNeedle& needle, float reach);

}  // namespace sightline::raster
