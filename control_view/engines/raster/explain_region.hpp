#pragma once

#include <cstdint>
#include <vector>

#include "control_view/engines/raster/kernel.hpp"
#include "control_view/engines/raster/owner_image.hpp"
#include "control_view/engines/raster/region_worker.hpp"

namespace sightline::raster {

/// An object that owns pixels of another.
struct PixelOwner {
  std::uint32_t object = 0;
  std::uint64_t pixels = 0;
};

/// Pixels of one object, in how many of them it shows, and who owns the others.
struct OwnedPixels {
  std::uint64_t alone = 0;
  std::uint64_t shown = 0;
  std::vector<PixelOwner> hidden_by;  ///< by object, each once

  /// Adds another region's.
  void add(const OwnedPixels& other);
};

/// A region of a view in which an object is to be explained.
struct ExplainJob {
  const KernelScene* whole = nullptr;
  const KernelScene* sole = nullptr;  ///< the object alone, see SoleObject; null: its box is looked for
  float box_nearest = 0.0f;           ///< of the box, which then fills the region
  const RasterView* view = nullptr;
  const NeedleItem* needles = nullptr;  ///< of `whole`, see RegionJob
  std::uint32_t needle_count = 0;
  RasterRegion region;
  ItemCode code = k_background_code;  ///< the object's in `whole`
};

/// Images that are kept from region to region.
struct ExplainImages {
  OwnerImage whole, sole;
};

/// Draws the region with everything and with the object alone, and compares pixel by pixel. An opaque object
/// shows where it owns the pixel; anything of it that is in front of all that is opaque (a blended object)
/// shows too. A box shows where nothing is certainly nearer than its nearest point.
[[nodiscard]] OwnedPixels explain_region(const KernelFunctions& kernel, const ExplainJob& job,
                                         RegionWorker& worker, ExplainImages& images);

}  // namespace sightline::raster
