#pragma once

#include <limits>
#include <vector>

#include "common/view.hpp"
#include "control_view/engines/raster/kernel.hpp"

namespace sightline::raster {

/// Memory of a DepthImage.
class WholeDepth {
 public:
  /// Makes room for a view of `size`; keeps what is there when that is its size already.
  void resize(ImageSize size) {
    if (size == size_) return;
    size_ = size;
    const std::size_t border = k_most_erosion;
    stride_ = size.width + 2 * border + k_block;
    // Blocks reach beyond an image's upper edge, and vectors beyond its last pixel.
    depth_.assign(stride_ * (size.height + 2 * border + k_block) + k_padding,
                  std::numeric_limits<float>::infinity());
  }
  [[nodiscard]] DepthImage image() {
    return {depth_.data() + k_most_erosion * stride_ + k_most_erosion, static_cast<std::int32_t>(stride_)};
  }

 private:
  ImageSize size_;
  std::size_t stride_ = 0;
  std::vector<float> depth_;
};

}  // namespace sightline::raster
