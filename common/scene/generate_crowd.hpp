#pragma once

#include <cstdint>

#include "common/camera_path.hpp"
#include "common/scene/scene.hpp"

namespace sightline {

/// A crowd of exactly `object_count` objects (at least 1), the same for the same count and seed on every
/// machine: small standing figures in walled courts of 20 x 20 m, with columns between them. The gaps in the
/// walls are staggered, so that nobody looks through many courts. Figures hide one another: the opposite of a
/// city's few large occluders. Throws InputError for a count of 0.
[[nodiscard]] Scene generate_crowd(std::uint32_t object_count, std::uint64_t seed);

/// A walk through that crowd: 60 s at 60 Hz round four neighbouring courts through their gaps, eyes at 1.7 m,
/// along lanes that figures keep free.
[[nodiscard]] CameraPath crowd_path(std::uint32_t object_count, std::uint64_t seed);

}  // namespace sightline
