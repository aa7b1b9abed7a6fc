#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "common/object_hierarchy.hpp"
#include "control_view/engines/raster/raster_scene.hpp"

namespace sightline::raster {

/// Pixels of a view are kept in blocks of 8 x 8, block by block, rows within a block from the bottom.
inline constexpr int k_block = 8;
inline constexpr int k_block_pixels = k_block * k_block;

/// One eye's image, pixels from the lower left. Columns of the matrix are those of depth_clip_from_scene:
/// depth 1 near, 0 far.
struct RasterView {
  float clip_from_scene[4][4] = {};  ///< [column][row]
  std::int32_t image_width = 0;
  std::int32_t image_height = 0;
};

/// A rectangle of a view's image, pixels.
struct RasterRegion {
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int32_t width = 0;
  std::int32_t height = 0;
};

enum class BlockState : std::uint8_t {
  untouched,  ///< holds nothing yet, not even zeros
  clean,      ///< its farthest depth is known
  dirty,      ///< its farthest depth is at least the one noted
};

/// What kernels read of a scene and of the hierarchy over it. Plain pointers throughout: a function of the
/// standard library that a kernel instantiated could be the one the linker keeps for the whole program, with
/// instructions that the machine lacks.
struct KernelScene {
  const float *x, *y, *z, *u, *v;  ///< u and v null without mask materials
  const std::uint8_t* corners[3];
  const Cluster* clusters;
  const Item* items;
  const std::uint32_t* first_item;
  const Placement* placements;
  const RankOwner* owners;
  std::uint32_t rank_shift;
  const std::uint8_t *has_opaque, *has_blended;
  const MaskMaterial* mask_materials;
  const AlphaTexture* alpha_textures;

  const ObjectHierarchy::Node* nodes;  ///< null when there are none
  const ObjectId* slots;
  const Aabb* bounds;  ///< by object, scene frame
};

struct RegionCount {
  std::uint32_t object;
  std::uint32_t pixels;
};

/// What one worker draws into. The blocks lie row by row; pixels outside the region hold a depth nearer than
/// anything, so that nothing is ever drawn there.
struct RegionMemory {
  float* depth;
  std::int32_t* rank;          ///< and k_padding more
  std::int32_t* blended_mark;  ///< the blended draw that a pixel was last counted in
  float* block_far;            ///< by block, and k_padding more: nothing in it is farther
  BlockState* block_state;

  // Each as long as there are ranks.
  std::uint32_t* drawn_in;        ///< the round a cluster was last drawn in
  std::uint32_t* pixels_of_rank;  ///< zero between rounds
  std::uint32_t* seen_ranks;      ///< those that own a pixel, in no order

  /// By item: twice the round in which it was found out whether it is cut, and one if it is.
  std::uint32_t* item_cut;

  // Each as long as there are objects.
  std::uint32_t* object_drawn_in;  ///< the round any of an object was last drawn in
  std::uint32_t* blended_candidates;

  /// The answer, in no order: one entry a rank that shows and one a blended object, so several an object.
  RegionCount* counts;

  std::uint32_t round = 0;         ///< another one for every call
  std::int32_t blended_draws = 0;  ///< goes on from call to call, so that marks need no clearing
};

/// One region of one view.
struct RegionJob {
  const KernelScene* scene = nullptr;
  const RasterView* view = nullptr;
  RasterRegion region;
  const std::uint32_t* first = nullptr;  ///< ranks to begin with: what showed last, nearest first
  std::uint32_t first_count = 0;
};

struct RegionResult {
  std::uint32_t count_count;  ///< entries of RegionMemory::counts
  std::uint32_t seen_count;   ///< entries of RegionMemory::seen_ranks
  std::uint32_t drawn_objects;
  std::uint64_t drawn_triangles;
};

/// Draws what the region shows of the scene and counts it into memory.counts. One for each instruction set;
/// all give the same counts.
using DrawRegion = RegionResult (*)(const RegionJob& job, RegionMemory& memory);

struct RasterKernel {
  std::string_view name;
  bool supported = false;  ///< by this machine
  DrawRegion draw = nullptr;
};

/// Best first.
[[nodiscard]] std::span<const RasterKernel> raster_kernels();

namespace avx512 {
RegionResult draw_region(const RegionJob& job, RegionMemory& memory);
}
namespace avx2 {
RegionResult draw_region(const RegionJob& job, RegionMemory& memory);
}
namespace sse41 {
RegionResult draw_region(const RegionJob& job, RegionMemory& memory);
}
namespace plain {
RegionResult draw_region(const RegionJob& job, RegionMemory& memory);
}

}  // namespace sightline::raster
