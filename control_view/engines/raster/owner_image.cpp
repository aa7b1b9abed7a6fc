#include "control_view/engines/raster/owner_image.hpp"

namespace sightline::raster {

void read_owners(const RasterRegion& region, const KernelScene& scene, const RegionMemory& memory,
                 OwnerImage& image) {
  const std::size_t pixels = static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height);
  image.codes.assign(pixels, k_background_code);
  image.depth.assign(pixels, 0.0f);
  const std::int32_t blocks_x = (region.width + k_block - 1) / k_block;
  std::size_t at = 0;
  for (std::int32_t y = 0; y < region.height; ++y) {
    for (std::int32_t x = 0; x < region.width; ++x, ++at) {
      const std::int32_t block = y / k_block * blocks_x + x / k_block;
      if (memory.block_state[block] == BlockState::untouched) continue;
      const std::int32_t in_block = block * k_block_pixels + y % k_block * k_block + x % k_block;
      const std::int32_t rank = memory.rank[in_block];
      if (rank == 0) continue;
      image.codes[at] = code_of(ObjectId{scene.owners[rank].object});
      image.depth[at] = memory.depth[in_block];
    }
  }
}

}  // namespace sightline::raster
