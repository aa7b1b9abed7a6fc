#pragma once

#include <cstdint>
#include <vector>

#include "common/object_id.hpp"
#include "control_view/engines/raster/kernel.hpp"

namespace sightline::raster {

/// A region's pixels, row by row from the bottom: which object owns each, and how near it is there.
struct OwnerImage {
  std::vector<ItemCode> codes;
  std::vector<float> depth;  ///< 1 near, 0 far and where nothing is
};

/// The image of the region last drawn with `memory`, from the scene it was drawn of.
void read_owners(const RasterRegion& region, const KernelScene& scene, const RegionMemory& memory,
                 OwnerImage& image);

}  // namespace sightline::raster
