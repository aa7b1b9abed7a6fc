#pragma once

#include <string>

namespace sightline {

/// What a surface without a texture is made to look like; goes by how far the scene reaches.
enum class SceneStyle {
  thing,     ///< plain, with a little grain
  building,  ///< seen from within: tiles and blocks
  town       ///< walls with windows, pitched roofs with tiles, haze
};

/// How many point lights the shading takes.
inline constexpr int k_point_light_count = 4;

/// Uniform locations that the programs below share.
struct ShadingLocations {
  static constexpr int k_eye = 1;              ///< vec3, scene frame
  static constexpr int k_sun = 2;              ///< vec3, unit, towards the sun
  static constexpr int k_haze_per_m = 3;       ///< float
  static constexpr int k_light_position = 16;  ///< vec4[k_point_light_count]: scene frame; 1 / reach^2 in w
  static constexpr int k_light_color = 24;     ///< vec4[k_point_light_count]
  static constexpr int k_ray_center = 5;       ///< vec3: view direction of the image's centre (sky only)
  static constexpr int k_ray_right = 6;        ///< vec3: what a step of 1 in clip x adds
  static constexpr int k_ray_up = 7;           ///< vec3
};

[[nodiscard]] std::string shading_vertex_glsl();
/// `masked`: with the alpha test, and so without the early depth test. `blended`: for surfaces one looks
/// through.
[[nodiscard]] std::string shading_fragment_glsl(SceneStyle style, bool masked, bool blended);
[[nodiscard]] std::string sky_vertex_glsl();
[[nodiscard]] std::string sky_fragment_glsl();

}  // namespace sightline
