#pragma once

#include <span>
#include <vector>

#include "common/gl/gpu_scene.hpp"
#include "main_view/app/image.hpp"

namespace sightline {

/// Layers of every pixel: how many fragments a renderer would produce there without a depth test.
struct LayerCounts {
  ImageSize size;
  std::vector<std::uint16_t> layers;  ///< rows from the top
  std::uint32_t max = 0;
  double mean = 0.0;      ///< over all pixels, empty ones too
  gl::DrawStats drawn{};  ///< an object with two layers counts in each
};

/// Counts layers. Both layers of an object count, fragments that the alpha test or back-face culling drops do
/// not: the measure of Klimenko, Nikitina and Nikitin, figure 5.
class DepthComplexity {
 public:
  /// Throws MachineError when the driver refuses the size.
  explicit DepthComplexity(ImageSize size);

  /// Layers of `ids` (ascending) as seen by `eye`. Exact up to 65,535 layers.
  [[nodiscard]] LayerCounts count(gl::GpuScene& scene, const Eye& eye, std::span<const ObjectId> ids);

 private:
  ImageSize size_;
  gl::TextureName counter_;
  gl::Framebuffer framebuffer_;
  gl::Program solid_, mask_;
};

/// The counts as colours: dark for none, then blue through green and yellow to red at `full_scale` layers and
/// above, with a legend in the corner. Two maps that shall be compared take the same `full_scale`.
[[nodiscard]] Image depth_complexity_image(const LayerCounts& counts, std::uint32_t full_scale);

}  // namespace sightline
