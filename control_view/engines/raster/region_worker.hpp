#pragma once

#include <cstdint>
#include <vector>

#include "control_view/engines/raster/closeup.hpp"
#include "control_view/engines/raster/kernel.hpp"
#include "control_view/engines/raster/owner_image.hpp"
#include "control_view/engines/raster/whole_depth.hpp"

namespace sightline::raster {

/// One worker's memory, kept from frame to frame so that nothing is allocated in the steady state, and what
/// it counted.
class RegionWorker {
 public:
  RegionWorker(const RasterScene& scene, bool any_blended);

  /// Draws a region of a view and adds what it shows to counts_of(eye) and seen_of(eye).
  void draw(const KernelFunctions& kernel, const RegionJob& job, std::size_t eye);

  /// Copies the region drawn last into a whole view's depth.
  void copy_depth(const KernelFunctions& kernel, const RasterRegion& region, const DepthImage& image) const {
    kernel.copy_depth(region, memory_, image);
  }
  /// Adds what the region leaves open to open_of(eye).
  void probe(const KernelFunctions& kernel, const ProbeJob& job, std::size_t eye);

  /// Looks closer at a part of a view: see Closeup. Appends to `kept` those of its candidates that show or
  /// stay open.
  void look_closer(const KernelFunctions& kernel, const Closeup& closeup, WholeDepth& depth,
                   std::vector<std::uint32_t>& kept);

  /// Draws a region of a view and says who owns its pixels; counts nothing.
  RegionResult draw_image(const KernelFunctions& kernel, const RegionJob& job, OwnerImage& image);

  /// Forgets what was counted and makes room for the next views: `eyes` of them, no region of more than
  /// `blocks` blocks.
  void begin(std::size_t eyes, std::size_t blocks);
  [[nodiscard]] const std::vector<RegionCount>& counts_of(std::size_t eye) const { return counts_[eye]; }
  [[nodiscard]] const std::vector<RegionCount>& open_of(std::size_t eye) const { return open_[eye]; }
  /// The ranks that own a pixel, in no order; twice where the eye's view was cut.
  [[nodiscard]] const std::vector<std::uint32_t>& seen_of(std::size_t eye) const { return seen_[eye]; }
  [[nodiscard]] std::uint32_t drawn_objects() const noexcept { return drawn_objects_; }
  [[nodiscard]] std::uint64_t drawn_triangles() const noexcept { return drawn_triangles_; }

 private:
  void begin_round();

  bool any_blended_;
  std::vector<float> depth_, block_far_;
  std::vector<std::int32_t> rank_, blended_mark_;
  std::vector<BlockState> block_state_;
  std::vector<std::uint32_t> drawn_in_, pixels_of_rank_, seen_ranks_, item_cut_;
  std::vector<std::uint32_t> object_drawn_in_, blended_candidates_;
  std::vector<ShownIn> shown_of_rank_;
  std::vector<RegionCount> region_counts_;
  RegionMemory memory_{};
  std::vector<std::vector<RegionCount>> counts_, open_;
  std::vector<std::vector<std::uint32_t>> seen_;
  std::uint32_t drawn_objects_ = 0;
  std::uint64_t drawn_triangles_ = 0;
};

}  // namespace sightline::raster
