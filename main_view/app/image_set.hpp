#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "main_view/app/drawable_scene.hpp"

namespace sightline {

/// What the pictures of write_image_set say in numbers.
struct ImageSetResult {
  std::uint64_t wrong_pixels = 0;  ///< pixels of the colour image that differ with and without culling
  std::uint32_t depth_complexity_frustum_max = 0;
  std::uint32_t depth_complexity_drawn_max = 0;
  double depth_complexity_frustum_mean = 0.0;
  double depth_complexity_drawn_mean = 0.0;
};

/// Draws one view in every way that shows what the culling did, and writes PNGs to `folder` (made when
/// missing): with_culling, without_culling, difference, item_buffer, frozen_view, depth_complexity_frustum
/// and depth_complexity_drawn. `drawn` (ascending) is what the culling kept; "frustum" is what view-frustum
/// culling alone keeps. Both depth-complexity maps share one scale. Throws InputError when a file cannot be
/// written.
ImageSetResult write_image_set(const std::filesystem::path& folder, DrawableScene& scene, const Eye& eye,
                               ImageSize size, std::span<const ObjectId> drawn);

}  // namespace sightline
