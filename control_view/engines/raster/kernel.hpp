#pragma once

#include <cstddef>
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

/// Where something showed: pixels of the whole image, ends included and whole blocks, and a depth that it is
/// nowhere nearer than.
struct ShownIn {
  std::int32_t left, bottom, right, top;
  float nearest;
};

struct RegionCount {
  std::uint32_t object;
  std::uint32_t pixels;
  ShownIn shown;
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
  ShownIn* shown_of_rank;         ///< of the ranks that own a pixel
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

/// An object that is looked for by its box alone, once everything else is drawn.
struct BoxedItem {
  Aabb box;  ///< scene frame
  std::uint32_t object = 0;
};

/// One region of one view.
struct RegionJob {
  const KernelScene* scene = nullptr;
  const RasterView* view = nullptr;
  RasterRegion region;
  const std::uint32_t* first = nullptr;  ///< ranks to begin with: what showed last, nearest first
  std::uint32_t first_count = 0;
  const BoxedItem* boxes = nullptr;
  std::uint32_t box_count = 0;
  const NeedleItem* needles = nullptr;  ///< to be drawn whatever hides them; by object
  std::uint32_t needle_count = 0;
};

struct RegionResult {
  std::uint32_t count_count;  ///< entries of RegionMemory::counts
  std::uint32_t seen_count;   ///< entries of RegionMemory::seen_ranks
  std::uint32_t drawn_objects;
  std::uint64_t drawn_triangles;
};

/// Farthest that a depth image is eroded, pixels: what its border holds on every side.
inline constexpr int k_most_erosion = 8;

/// Depths of a whole view, row by row from the bottom, with a border of k_most_erosion pixels (and k_padding
/// more at the end) nearer than anything.
struct DepthImage {
  float* first = nullptr;  ///< of pixel 0, 0
  std::int32_t stride = 0;

  [[nodiscard]] float* at(std::int32_t x, std::int32_t y) const {
    return first + static_cast<std::ptrdiff_t>(y) * stride + x;
  }
};

/// By how many pixels a surface is taken to be smaller: linear in its depth (1 near, 0 far), as the way is
/// that a point moves in the image when the eye does.
struct ErosionRadius {
  float at_far_px = 1.0f;
  float per_depth_px = 0.0f;
};

/// One region of a view that has been drawn: what did not show in it but might?
struct ProbeJob {
  const KernelScene* scene = nullptr;
  const RasterView* view = nullptr;
  RasterRegion region;
  DepthImage image;
  ErosionRadius radius;
  int rim_blocks = 0;       ///< blocks along the region's edges that are only there to be looked at
  bool both_sides = false;  ///< faces that turn away too: another eye may see their fronts
  const std::uint8_t* known = nullptr;  ///< by object: not 0 for those that need no probe; null: none
  /// These objects alone; null: whatever the hierarchy holds.
  const std::uint32_t* candidates = nullptr;
  std::uint32_t candidate_count = 0;
  /// Open blocks of an object are looked for until the rectangle around them is larger than this.
  int enough_blocks = 0;
};

/// Draws what the region shows of the scene and counts it into memory.counts. One for each instruction set;
/// all give the same counts.
using DrawRegion = RegionResult (*)(const RegionJob& job, RegionMemory& memory);

/// Of the objects that are not known, those with a triangle that somewhere lies in front of the eroded depth:
/// one entry each in memory.counts, its `pixels` the blocks of the rectangle around those found open, `shown`
/// that rectangle, or the object's box where it is larger than enough_blocks. What the memory's image held is
/// lost. A triangle is taken as large as the pixels it touches, and everywhere as near as its nearest point
/// within the pixel: errs towards finding.
using ProbeRegion = RegionResult (*)(const ProbeJob& job, RegionMemory& memory);

/// Copies the region last drawn into a whole view's depth.
using CopyDepth = void (*)(const RasterRegion& region, const RegionMemory& memory, const DepthImage& image);

/// A corner snaps to 1/256 pixel: by half of that each way.
inline constexpr float k_needle_snap_px = 1.0f / 256.0f;
/// A needle's thickness in the image, in units of what rounding may move its corners by: where it is less as
/// OpenGL has the corners, depth may go astray; where it is less as they really are, it may be anything.
inline constexpr float k_needle_astray = 1.0f / 64.0f;
inline constexpr float k_needle_sure = 2.0f;

/// k_padding needles, corners in the scene frame as the vertex shader has them.
struct NeedleGroup {
  const float* x[3];
  const float* y[3];
  const float* z[3];
};

/// A part of a view that may show needles.
struct NeedleView {
  RasterView image;
  RasterRegion part;
  /// By how much rounding may move a corner in the image: pixels, and pixels at a distance w of 1.
  float noise_px = 0.0f;
  float noise_px_w = 0.0f;
  float noise_w = 0.0f;  ///< the same for w
};

/// Bit i: needle i of the group may own the centre of a pixel of the part, with a depth that has gone astray.
/// Errs towards set.
using FindNeedles = unsigned (*)(const NeedleView& view, const NeedleGroup& group);

/// What each instruction set has.
struct KernelFunctions {
  DrawRegion draw;
  CopyDepth copy_depth;
  ProbeRegion probe;
  FindNeedles find_needles;
};

struct RasterKernel {
  std::string_view name;
  bool supported = false;  ///< by this machine
  const KernelFunctions* functions = nullptr;
};

/// Best first.
[[nodiscard]] std::span<const RasterKernel> raster_kernels();
/// The first of them that this machine supports.
[[nodiscard]] const KernelFunctions& best_kernel();

namespace avx512 {
extern const KernelFunctions k_functions;
}
namespace avx2 {
extern const KernelFunctions k_functions;
}
namespace sse41 {
extern const KernelFunctions k_functions;
}
namespace plain {
extern const KernelFunctions k_functions;
}

}  // namespace sightline::raster
