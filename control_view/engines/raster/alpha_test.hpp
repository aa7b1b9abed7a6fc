// Included by the kernels only: SIGHTLINE_LANES names the namespace of their instruction set.
#pragma once

#include "control_view/engines/raster/lanes.hpp"
#include "control_view/engines/raster/raster_scene.hpp"

namespace sightline::raster::SIGHTLINE_LANES {

/// Two neighbouring texels along one axis and the weight of the second.
struct TexelPair {
  std::uint32_t first = 0;
  std::uint32_t second = 0;
  float weight = 0.0f;
};

/// OpenGL's LINEAR filter at coordinate `s`. Follows llvmpipe's arithmetic, which has a way of its own for
/// powers of two.
inline TexelPair texels_at(float s, std::uint32_t size, bool repeats) {
  const auto extent = static_cast<float>(size);
  if (!__builtin_isfinite(s)) return {};
  if (!repeats) {
    float at = s * extent < extent ? s * extent : extent;
    at = at - 0.5f > 0.0f ? at - 0.5f : 0.0f;
    const float whole = __builtin_floorf(at);
    const auto first =
        static_cast<std::uint32_t>(whole) < size ? static_cast<std::uint32_t>(whole) : size - 1;
    return {first, first + 1 < size ? first + 1 : size - 1, at - whole};
  }
  if ((size & (size - 1)) == 0) {
    const float at = s * extent - 0.5f;
    const float whole = __builtin_floorf(at);
    // Modulo first: an integer may not hold it.
    const float wrapped = whole - __builtin_floorf(whole / extent) * extent;
    const auto first = static_cast<std::uint32_t>(wrapped) & (size - 1);
    return {first, (first + 1) & (size - 1), at - whole};
  }
  const float at = (s - __builtin_floorf(s)) * extent - 0.5f;
  const float whole = __builtin_floorf(at);
  const auto first = at < 0.0f                                  ? size - 1
                     : static_cast<std::uint32_t>(whole) < size ? static_cast<std::uint32_t>(whole)
                                                                : size - 1;
  return {first, first + 1 == size ? 0 : first + 1, at - whole};
}

/// Alpha at level 0, bilinear.
inline float alpha_at(const AlphaTexture& texture, float u, float v) {
  const TexelPair x = texels_at(u, texture.width, texture.repeat_u);
  const TexelPair y = texels_at(v, texture.height, texture.repeat_v);
  const auto row = [&](std::uint32_t texel_y) {
    const std::uint8_t* const texels = texture.texels + std::size_t{texel_y} * texture.width;
    const float a = static_cast<float>(texels[x.first]) * (1.0f / 255.0f);
    const float b = static_cast<float>(texels[x.second]) * (1.0f / 255.0f);
    return __builtin_fmaf(x.weight, b - a, a);
  };
  const float upper = row(y.first), lower = row(y.second);
  return __builtin_fmaf(y.weight, lower - upper, upper);
}

}  // namespace sightline::raster::SIGHTLINE_LANES
