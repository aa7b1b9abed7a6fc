#pragma once

#include <cstdint>

#include "common/camera_path.hpp"
#include "common/scene/scene.hpp"

namespace sightline {

/// A city of exactly `object_count` objects (at least 1), the same for the same count and seed on every
/// machine.
///
/// Closed blocks of eight buildings stand in rows shifted by half a block, so that no street across the rows
/// is longer than one block; streets along the rows are closed by a bridge house every fourth block. What can
/// be seen from the street is therefore about a hundred objects, however large the city. About 130 triangles
/// an object in the mean. Cars have blended windows, windows blended glass and trees masked leaves. Throws
/// InputError for a count of 0.
[[nodiscard]] Scene generate_city(std::uint32_t object_count, std::uint64_t seed);

/// A walk through the streets of that city: 60 s at 60 Hz round a block in its middle, eyes at 1.7 m, never
/// nearer than 1.5 m to an object other than the ground.
[[nodiscard]] CameraPath city_path(std::uint32_t object_count, std::uint64_t seed);

}  // namespace sightline
