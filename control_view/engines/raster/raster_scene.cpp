#include "control_view/engines/raster/raster_scene.hpp"

#include <algorithm>
#include <memory>
#include <numeric>
#include <thread>

#include <glm/matrix.hpp>

#include "control_view/engines/raster/cluster_builder.hpp"

namespace sightline::raster {
namespace {

Placement placement_of(const glm::dmat4& scene_from_object) {
  Placement placement;
  const glm::mat4 single(scene_from_object);
  placement.identity = single == glm::mat4(1.0f);
  placement.mirrored = glm::determinant(glm::dmat3(scene_from_object)) < 0.0;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row) placement.columns[column][row] = single[column][row];
  }
  return placement;
}

/// How many ranks an item takes where each stands for 2^shift clusters.
std::uint32_t ranks_of(const Item& item, std::uint32_t shift) {
  const std::uint32_t clusters = item.end_cluster - item.first_cluster;
  return static_cast<std::uint32_t>((std::uint64_t{clusters} + (std::uint64_t{1} << shift) - 1) >> shift);
}

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// A run of primitives, and the clusters made of it.
struct Part {
  std::size_t first_primitive = 0;
  std::size_t end_primitive = 0;
  std::unique_ptr<ClusterBuilder> built;
  std::vector<std::uint32_t> cluster_counts;  ///< by primitive of the run
};

/// Runs of about equally many triangles.
std::vector<Part> equal_parts(const Scene& scene, std::size_t count) {
  const auto total = std::accumulate(
      scene.primitives.begin(), scene.primitives.end(), std::uint64_t{0},
      [](std::uint64_t sum, const Primitive& primitive) { return sum + primitive.index_count; });
  std::vector<Part> parts(count);
  std::size_t primitive = 0;
  std::uint64_t reached = 0;
  for (std::size_t i = 0; i < count; ++i) {
    parts[i].first_primitive = primitive;
    const std::uint64_t goal = total * (i + 1) / count;
    while (primitive < scene.primitives.size() && (reached < goal || i + 1 == count)) {
      reached += scene.primitives[primitive++].index_count;
    }
    parts[i].end_primitive = primitive;
  }
  return parts;
}

void build(const Scene& scene, bool with_uvs, Part& part) {
  part.built = std::make_unique<ClusterBuilder>(scene, with_uvs);
  for (std::size_t i = part.first_primitive; i < part.end_primitive; ++i) {
    part.cluster_counts.push_back(part.built->add(scene.primitives[i]));
  }
}

}  // namespace

RasterScene::RasterScene(const Scene& scene, std::uint32_t threads, std::uint64_t most_ranks,
                         std::span<const MeshTriangle> needles)
    : world_origin_m(scene.world_origin_m) {
  const bool with_uvs =
      !scene.uvs.empty() && std::any_of(scene.materials.begin(), scene.materials.end(),
                                        [](const Material& m) { return m.alpha_mode == AlphaMode::mask; });
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  constexpr std::size_t k_worthwhile_indices = 100'000;
  std::vector<Part> parts =
      equal_parts(scene, std::clamp<std::size_t>(scene.indices.size() / k_worthwhile_indices, 1, threads));
  {
    std::vector<std::jthread> workers;
    for (std::size_t i = 1; i < parts.size(); ++i) {
      workers.emplace_back([&, i] { build(scene, with_uvs, parts[i]); });
    }
    build(scene, with_uvs, parts[0]);
  }

  std::vector<std::uint32_t> first_cluster_of_primitive{0};
  for (Part& part : parts) {
    for (Cluster cluster : part.built->clusters) {
      cluster.first_vertex += static_cast<std::uint32_t>(x.size());
      cluster.first_triangle += static_cast<std::uint32_t>(corners[0].size());
      clusters.push_back(cluster);
    }
    append(x, part.built->x);
    append(y, part.built->y);
    append(z, part.built->z);
    append(u, part.built->u);
    append(v, part.built->v);
    for (int corner = 0; corner < 3; ++corner) append(corners[corner], part.built->corners[corner]);
    for (const std::uint32_t count : part.cluster_counts) {
      first_cluster_of_primitive.push_back(first_cluster_of_primitive.back() + count);
    }
    part.built.reset();
  }

  append_needles(scene, needles, first_cluster_of_primitive);
  make_items(scene, first_cluster_of_primitive);
  make_mask_materials(scene);
  choose_rank_shift(most_ranks);
  make_ranks();
}

void RasterScene::append_needles(const Scene& scene, std::span<const MeshTriangle> needles,
                                 const std::vector<std::uint32_t>& first_cluster_of_primitive) {
  first_needle_cluster_ = static_cast<std::uint32_t>(clusters.size());
  for (const MeshTriangle& needle : needles) {
    Cluster cluster;
    cluster.first_vertex = static_cast<std::uint32_t>(x.size());
    cluster.first_triangle = static_cast<std::uint32_t>(corners[0].size());
    cluster.vertex_count = 3;
    cluster.triangle_count = 1;
    // Vectors read the padding: it repeats the last corner.
    for (std::uint32_t i = 0; i < k_padding; ++i) {
      const std::uint32_t vertex = scene.indices[needle.first_index + std::min(i, 2u)];
      const glm::vec3& position = scene.positions[vertex];
      cluster.box.add(position);
      x.push_back(position.x);
      y.push_back(position.y);
      z.push_back(position.z);
      if (u.empty()) continue;
      u.push_back(scene.uvs[vertex].x);
      v.push_back(scene.uvs[vertex].y);
    }
    for (std::uint8_t corner = 0; corner < 3; ++corner) {
      corners[corner].resize(corners[corner].size() + k_padding, corner);
    }
    clusters.push_back(cluster);
    first_cluster_of_needle_.push_back(first_cluster_of_primitive[needle.primitive]);
  }
}

void RasterScene::find_items_of(std::span<const Needle> needles, std::vector<NeedleItem>& items_of) const {
  items_of.clear();
  for (const Needle& needle : needles) {
    const auto item = std::lower_bound(
        items.begin() + first_item[needle.object], items.begin() + first_item[needle.object + 1],
        first_cluster_of_needle_[needle.triangle],
        [](const Item& an_item, std::uint32_t cluster) { return an_item.first_cluster < cluster; });
    items_of.push_back(
        {static_cast<std::uint32_t>(item - items.begin()), first_needle_cluster_ + needle.triangle});
  }
}

void RasterScene::make_items(const Scene& scene,
                             const std::vector<std::uint32_t>& first_cluster_of_primitive) {
  for (std::uint32_t object = 0; object < scene.object_count(); ++object) {
    first_item.push_back(static_cast<std::uint32_t>(items.size()));
    placements.push_back(placement_of(scene.objects[object].scene_from_object));
    has_opaque.push_back(0);
    has_blended.push_back(0);
    const Mesh& mesh = scene.meshes[scene.objects[object].mesh];
    for (std::uint32_t i = 0; i < mesh.primitive_count; ++i) {
      const std::uint32_t index = mesh.first_primitive + i;
      const Primitive& primitive = scene.primitives[index];
      const Material& material = scene.materials[primitive.material];
      Item item;
      item.object = object;
      item.first_cluster = first_cluster_of_primitive[index];
      item.end_cluster = first_cluster_of_primitive[index + 1];
      item.material = primitive.material;
      item.double_sided = material.double_sided;
      item.masked = material.alpha_mode == AlphaMode::mask;
      item.blended = material.alpha_mode == AlphaMode::blend;
      if (item.first_cluster == item.end_cluster) continue;
      (item.blended ? has_blended : has_opaque).back() = 1;
      items.push_back(item);
    }
  }
  first_item.push_back(static_cast<std::uint32_t>(items.size()));
}

void RasterScene::make_mask_materials(const Scene& scene) {
  std::vector<std::uint32_t> alpha_of_texture(scene.textures.size(), k_no_texture);
  for (const Material& material : scene.materials) {
    MaskMaterial mask{material.base_color.a, material.alpha_cutoff, k_no_texture};
    const bool textured = material.alpha_mode == AlphaMode::mask &&
                          material.texture < scene.textures.size() &&
                          !scene.textures[material.texture].rgba.empty();
    if (textured) {
      std::uint32_t& alpha = alpha_of_texture[material.texture];
      if (alpha == k_no_texture) {
        alpha = static_cast<std::uint32_t>(alpha_textures.size());
        const Texture& source = scene.textures[material.texture];
        std::vector<std::uint8_t>& texels = alpha_texels.emplace_back(source.rgba.size() / 4);
        for (std::size_t i = 0; i < texels.size(); ++i) texels[i] = source.rgba[4 * i + 3];
        alpha_textures.push_back(
            {source.width, source.height, source.repeat_u, source.repeat_v, texels.data()});
      }
      mask.texture = alpha;
    }
    mask_materials.push_back(mask);
  }
}

/// Instances of a large mesh share its clusters but not their ranks, of which each takes 12 bytes, and as
/// much again for every worker.
void RasterScene::choose_rank_shift(std::uint64_t most_ranks) {
  for (rank_shift = 0; rank_shift < 31; ++rank_shift) {
    std::uint64_t ranks = 0;
    for (const Item& item : items) ranks += ranks_of(item, rank_shift);
    // Two an item, or one for those of one cluster, can always be had.
    if (ranks <= std::max<std::uint64_t>(most_ranks, 2 * items.size())) return;
  }
}

void RasterScene::make_ranks() {
  // Groups as GpuScene draws them: sides, winding and alpha test decide, then the object, then its primitive.
  const auto group_of = [this](const Item& item) {
    return (item.double_sided ? 1 : 0) | (placements[item.object].mirrored ? 2 : 0) | (item.masked ? 4 : 0);
  };
  std::uint32_t in_group[8] = {};
  for (const Item& item : items) in_group[group_of(item)] += ranks_of(item, rank_shift);
  std::uint32_t next[8];
  std::uint32_t first = 1;
  for (int group = 0; group < 8; ++group) {
    next[group] = first;
    first += in_group[group];
  }
  owners.resize(first);
  for (std::uint32_t i = 0; i < items.size(); ++i) {
    Item& item = items[i];
    std::uint32_t& rank = next[group_of(item)];
    item.first_rank = static_cast<std::int32_t>(rank);
    for (std::uint32_t part = 0; part < ranks_of(item, rank_shift); ++part) {
      owners[rank++] = {item.object, i, item.first_cluster + (part << rank_shift)};
    }
  }
}

void RasterScene::set_transforms(std::span<const ObjectId> ids,
                                 std::span<const glm::dmat4> scene_from_object) {
  bool any_turned = false;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    Placement& placement = placements[index_of(ids[i])];
    const bool mirrored = placement.mirrored;
    placement = placement_of(scene_from_object[i]);
    any_turned = any_turned || placement.mirrored != mirrored;
  }
  if (any_turned) make_ranks();
}

}  // namespace sightline::raster
