#pragma once

#include <span>

#include <glm/vec2.hpp>

#include "common/camera_path.hpp"

namespace sightline {

/// A 60 s, 60 Hz walk once round a closed polygon of ground points (x, z), eyes 1.7 m above y = 0, at
/// constant speed. Corners are rounded by averaging over `smoothing_s` seconds, which stays inside the
/// corner; the view follows the way ahead and sways to both sides, as a walker looks about. Needs three
/// points or more.
[[nodiscard]] CameraPath walk_round(std::span<const glm::dvec2> corners, double smoothing_s = 1.5);

}  // namespace sightline
