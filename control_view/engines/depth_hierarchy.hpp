#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/view.hpp"
#include "control_view/engines/screen_box.hpp"

namespace sightline {

/// Farthest depth over tiles of a depth image, for asking whether something may show in a rectangle.
///
/// Depth is reversed: 1 near .. 0 far, 0 where nothing was drawn. Tiles are 8 and 64 pixels a side.
///
/// Source: Greene, Kass, Miller, "Hierarchical Z-Buffer Visibility", 1993. Where we differ: two coarse levels
/// and the pixels themselves, so that the answer about a rectangle is exact and not only conservative.
class DepthHierarchy {
 public:
  /// Looks at `depth` (rows from the bottom), which must outlive the questions. Allocates only when the image
  /// is larger than any before.
  void build(std::span<const float> depth, ImageSize size);

  /// Whether any pixel of the rectangle is at most as near as `box.nearest_depth`: equal depths may show.
  /// Exact. The rectangle must lie inside the image; its coordinates are the image's.
  [[nodiscard]] bool may_show(const ScreenBox& box) const noexcept;

 private:
  struct Level {
    std::uint32_t tile_side = 0;
    std::uint32_t columns = 0;
    std::uint32_t rows = 0;
    std::vector<float> farthest;
  };

  [[nodiscard]] bool may_show_in(const ScreenBox& box, int level) const noexcept;
  [[nodiscard]] bool any_pixel_as_far(const ScreenBox& box) const noexcept;

  std::span<const float> depth_;
  ImageSize size_;
  Level fine_, coarse_;
  std::vector<float> row_;
};

}  // namespace sightline
