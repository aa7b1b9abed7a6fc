#include "tests/control_view/plain_raster_texture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace sightline::test {
namespace {

struct Taps {
  int first = 0, second = 0;
  float weight = 0.0f;  ///< of the second
};

bool is_power_of_two(int length) {
  return (length & (length - 1)) == 0;
}

/// The two texels around a coordinate, on one axis.
Taps taps_at(float coordinate, int length, bool repeat) {
  const auto length_f = static_cast<float>(length);
  Taps taps;
  if (!std::isfinite(coordinate)) return taps;  // a sliver without area in floats
  if (!repeat) {
    const float texel = std::max(std::min(coordinate * length_f, length_f) - 0.5f, 0.0f);
    const float below = std::floor(texel);
    taps.first = static_cast<int>(below);
    taps.second = std::min(taps.first + 1, length - 1);
    taps.weight = texel - below;
    return taps;
  }
  const bool wraps_by_bits = is_power_of_two(length);
  const float wrapped = wraps_by_bits ? coordinate : coordinate - std::floor(coordinate);
  const float texel = wrapped * length_f - 0.5f;
  const float below = std::floor(texel);
  const auto index = static_cast<std::int64_t>(below);
  taps.first = static_cast<int>(((index % length) + length) % length);
  taps.second = (taps.first + 1) % length;
  taps.weight = texel - below;
  return taps;
}

float texel_alpha(const Texture& texture, int column, int row) {
  const std::size_t texel = static_cast<std::size_t>(row) * texture.width + static_cast<std::size_t>(column);
  return static_cast<float>(texture.rgba[4 * texel + 3]) * (1.0f / 255.0f);
}

float mixed(float a, float b, float weight) {
  return std::fma(weight, b - a, a);
}

}  // namespace

float sampled_alpha(const Texture& texture, const glm::vec2& uv) {
  const Taps column = taps_at(uv.x, static_cast<int>(texture.width), texture.repeat_u);
  const Taps row = taps_at(uv.y, static_cast<int>(texture.height), texture.repeat_v);
  const float first = mixed(texel_alpha(texture, column.first, row.first),
                            texel_alpha(texture, column.second, row.first), column.weight);
  const float second = mixed(texel_alpha(texture, column.first, row.second),
                             texel_alpha(texture, column.second, row.second), column.weight);
  return mixed(first, second, row.weight);
}

bool alpha_passes(const Scene& scene, const Material& material, const glm::vec2& uv) {
  const bool textured =
      material.texture < scene.textures.size() && !scene.textures[material.texture].rgba.empty();
  const float alpha = textured ? sampled_alpha(scene.textures[material.texture], uv) : 1.0f;
  return alpha * material.base_color.a >= material.alpha_cutoff;
}

}  // namespace sightline::test
