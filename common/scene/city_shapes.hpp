#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/scene/scene.hpp"

namespace sightline {

/// The meshes of a generated city. Every object is an instance of one of them, so that a city of any size
/// holds the same few thousand vertices. Metres; each stands on y = 0 about the origin.
struct CityShapes {
  static constexpr float k_building_side_m = 20.0f;
  static constexpr float k_street_width_m = 14.0f;

  std::uint32_t ground = 0;              ///< one block with half of the streets round it
  std::uint32_t bridge = 0;              ///< closes a street across: 14 m along z, 8 m along x
  std::vector<std::uint32_t> buildings;  ///< 20 x 20 m, of several heights and colours
  std::vector<std::uint32_t> cars;       ///< along x
  std::vector<std::uint32_t> trees;
  std::uint32_t window = 0;   ///< a frame with glass on a wall that faces +z
  std::uint32_t balcony = 0;  ///< on a wall that faces +z
  std::uint32_t lamp = 0;
  std::uint32_t fence = 0;  ///< along x
  std::uint32_t sign = 0;
};

/// Adds the materials, textures and meshes to an empty scene.
[[nodiscard]] CityShapes add_city_shapes(Scene& scene, float pitch_m);

}  // namespace sightline
