#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>

#include "common/object_id.hpp"
#include "common/scene/scene.hpp"
#include "control_view/engines/raster/needle.hpp"

namespace sightline::raster {

/// Most lanes of any instruction set: arrays that kernels read are padded to it.
inline constexpr std::uint32_t k_padding = 16;
/// Keeps a cluster's corners within a byte, three new vertices a triangle at worst.
inline constexpr std::uint32_t k_cluster_triangles = 64;
/// Vertices a cluster has at most, padding included.
inline constexpr std::uint32_t k_cluster_vertices = 3 * k_cluster_triangles;

/// Triangles that lie near each other, with vertices of their own. The unit that is tested, transformed and
/// set up at once; small enough for its vertices to stay in the nearest cache.
struct Cluster {
  Aabb box;                          ///< mesh frame
  std::uint32_t first_vertex = 0;    ///< a multiple of k_padding
  std::uint32_t first_triangle = 0;  ///< a multiple of k_padding
  std::uint16_t vertex_count = 0;
  std::uint16_t triangle_count = 0;
};

/// One primitive of one object.
struct Item {
  std::uint32_t object = 0;
  std::uint32_t first_cluster = 0;
  std::uint32_t end_cluster = 0;
  /// Rank of its first clusters; the others follow. Ranks are places in OpenGL's drawing order (GpuScene),
  /// from 1, and 0 is the background: where two surfaces coincide, the lower rank owns the pixel.
  std::int32_t first_rank = 0;
  std::uint32_t material = 0;
  bool double_sided = false;
  bool masked = false;
  bool blended = false;
};

/// A needle (see NeedleIndex) of an item: a cluster of that triangle alone.
struct NeedleItem {
  std::uint32_t item = 0;
  std::uint32_t cluster = 0;
};

/// What a rank stands for: a cluster of an item, or several neighbours where there would be too many ranks.
struct RankOwner {
  std::uint32_t object = 0;
  std::uint32_t item = 0;
  std::uint32_t first_cluster = 0;
};

/// Where an object stands, as the vertex shader has it: columns, single precision.
struct Placement {
  float columns[4][3] = {};
  bool identity = false;
  bool mirrored = false;
};

/// The alpha channel of a mask material's texture.
struct AlphaTexture {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  bool repeat_u = true;
  bool repeat_v = true;
  const std::uint8_t* texels = nullptr;  ///< rows from the top
};

struct MaskMaterial {
  float base_alpha = 1.0f;
  float cutoff = 0.5f;
  std::uint32_t texture = k_no_texture;  ///< index into RasterScene's own alpha textures
};

/// A scene laid out for the rasterizer: clusters of a mesh lie together and are shared by its instances,
/// coordinates apart from each other, corners as bytes.
///
/// Triangles may be reordered within a primitive, since all of them have the same rank; those without area in
/// the mesh frame are left out.
class RasterScene {
 public:
  /// Of more clusters than `most_ranks`, instances counted each, several share a rank. `needles` get clusters
  /// of their own besides those they share with their neighbours.
  RasterScene(const Scene& scene, std::uint32_t threads, std::uint64_t most_ranks,
              std::span<const MeshTriangle> needles);

  /// Replaces `items` by what stands for these needles, in their order.
  void find_items_of(std::span<const Needle> needles, std::vector<NeedleItem>& items_of) const;

  /// Sets placements, scene frame. Ranks are made anew only where an object turns its winding.
  void set_transforms(std::span<const ObjectId> ids, std::span<const glm::dmat4> scene_from_object);

  std::vector<float> x, y, z;            ///< by vertex, mesh frame
  std::vector<float> u, v;               ///< by vertex; empty without mask materials
  std::vector<std::uint8_t> corners[3];  ///< by triangle: vertex of its cluster
  std::vector<Cluster> clusters;
  std::vector<Item> items;                            ///< by object
  std::vector<std::uint32_t> first_item;              ///< of each object, and one past the last
  std::vector<Placement> placements;                  ///< by object
  std::vector<RankOwner> owners;                      ///< by rank; entry 0 is the background's
  std::uint32_t rank_shift = 0;                       ///< a rank stands for 2^rank_shift clusters
  std::vector<std::uint8_t> has_opaque, has_blended;  ///< by object
  std::vector<MaskMaterial> mask_materials;           ///< by material
  std::vector<AlphaTexture> alpha_textures;
  std::vector<std::vector<std::uint8_t>> alpha_texels;  ///< what they point to
  glm::dvec3 world_origin_m{0.0};

 private:
  void append_needles(const Scene& scene, std::span<const MeshTriangle> needles,
                      const std::vector<std::uint32_t>& first_cluster_of_primitive);
  void make_items(const Scene& scene, const std::vector<std::uint32_t>& first_cluster_of_primitive);
  void make_mask_materials(const Scene& scene);
  void choose_rank_shift(std::uint64_t most_ranks);
  void make_ranks();

  std::uint32_t first_needle_cluster_ = 0;
  std::vector<std::uint32_t> first_cluster_of_needle_;  ///< of the primitive it belongs to
};

}  // namespace sightline::raster
