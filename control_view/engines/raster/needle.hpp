#pragma once

#include <compare>
#include <cstdint>

namespace sightline::raster {

/// A triangle of a mesh: its corners are `first_index` of the scene's indices and the two after it.
struct MeshTriangle {
  std::uint32_t primitive = 0;
  std::uint32_t first_index = 0;

  auto operator<=>(const MeshTriangle&) const = default;
};

/// A needle of an object: `triangle` of NeedleIndex::triangles().
struct Needle {
  std::uint32_t object = 0;
  std::uint32_t triangle = 0;

  auto operator<=>(const Needle&) const = default;
};

}  // namespace sightline::raster
