// Included by the kernels only: SIGHTLINE_LANES names the namespace of their instruction set.
#pragma once

#include "control_view/engines/raster/alpha_test.hpp"
#include "control_view/engines/raster/box_test.hpp"
#include "control_view/engines/raster/clip.hpp"
#include "control_view/engines/raster/setup.hpp"

namespace sightline::raster::SIGHTLINE_LANES {

/// A cluster's vertices on their way to the screen.
struct ClusterVertices {
  float clip[4][k_cluster_vertices];
  float one_over_w[k_cluster_vertices];
  float x[k_cluster_vertices], y[k_cluster_vertices], depth[k_cluster_vertices];  ///< window
  std::int32_t outside[k_cluster_vertices];  ///< bit i: beyond clip plane i
};

/// The vertex shader and the perspective division, in llvmpipe's order: every product and sum rounded by
/// itself but for the step to the window. Returns the planes that any vertex lies beyond, found only where
/// `may_clip`.
inline unsigned transform(const KernelScene& scene, const Cluster& cluster, const Placement& placement,
                          const RasterView& view, bool may_clip, ClusterVertices& out) {
  const Floats half_width = all(0.5f * static_cast<float>(view.image_width));
  const Floats half_height = all(0.5f * static_cast<float>(view.image_height));
  Ints any_outside = all(0);
  for (int i = 0; i < cluster.vertex_count; i += k_lanes) {
    const std::size_t at = cluster.first_vertex + static_cast<std::size_t>(i);
    Floats p[3] = {load(scene.x + at), load(scene.y + at), load(scene.z + at)};
    if (!placement.identity) {
      Floats moved[3];
      for (int row = 0; row < 3; ++row) {
        moved[row] = all(placement.columns[0][row]) * p[0] + all(placement.columns[1][row]) * p[1];
        moved[row] = moved[row] + all(placement.columns[2][row]) * p[2] + all(placement.columns[3][row]);
      }
      for (int row = 0; row < 3; ++row) p[row] = moved[row];
    }
    Floats clip[4];
    for (int row = 0; row < 4; ++row) {
      clip[row] = all(view.clip_from_scene[0][row]) * p[0] + all(view.clip_from_scene[1][row]) * p[1];
      clip[row] = clip[row] + all(view.clip_from_scene[2][row]) * p[2] + all(view.clip_from_scene[3][row]);
    }
    const Floats one_over_w = all(1.0f) / clip[3];
    store(out.one_over_w + i, one_over_w);
    store(out.x + i, fused_multiply_add(clip[0] * one_over_w, half_width, half_width));
    store(out.y + i, fused_multiply_add(clip[1] * one_over_w, half_height, half_height));
    store(out.depth + i, clip[2] * one_over_w);
    if (!may_clip) continue;
    for (int row = 0; row < 4; ++row) store(out.clip[row] + i, clip[row]);
    const Floats zero = all(0.0f);
    const Ints outside = where(clip[0] > clip[3], 1) | where(zero > clip[0] + clip[3], 2) |
                         where(clip[1] > clip[3], 4) | where(zero > clip[1] + clip[3], 8) |
                         where(zero > clip[2], 16) | where(clip[2] > clip[3], 32);
    store(out.outside + i, outside);
    any_outside = any_outside | outside;
  }
  if (!may_clip) return 0;
  std::int32_t lanes[k_lanes];
  store(lanes, any_outside);
  unsigned planes = 0;
  for (int i = 0; i < k_lanes; ++i) planes |= static_cast<unsigned>(lanes[i]);
  return planes;
}

/// u / w, v / w and 1 / w over a triangle, which are linear in the window; the arithmetic is that of the
/// depth.
struct UvPlane {
  float at_origin[3], x[3], y[3];

  UvPlane(const Batch& b, int lane, bool counter_clockwise) {
    const int c0 = counter_clockwise ? 1 : 0, c1 = counter_clockwise ? 0 : 1, c2 = 2;
    const float x0 = b.x[c0][lane], y0 = b.y[c0][lane];
    float dx01 = x0 - b.x[c1][lane], dy01 = y0 - b.y[c1][lane];
    float dx20 = b.x[c2][lane] - x0, dy20 = b.y[c2][lane] - y0;
    const float one_over_area = 1.0f / (dx01 * dy20 - dy01 * dx20);
    dx01 *= one_over_area;
    dy01 *= one_over_area;
    dx20 *= one_over_area;
    dy20 *= one_over_area;
    const float(*const attributes[3])[k_lanes] = {b.u, b.v, b.one_over_w};
    for (int i = 0; i < 3; ++i) {
      const float value = attributes[i][c0][lane];
      const float d01 = value - attributes[i][c1][lane], d20 = attributes[i][c2][lane] - value;
      x[i] = d01 * dy20 - d20 * dy01;
      y[i] = d20 * dx01 - d01 * dx20;
      at_origin[i] = value - (x[i] * (x0 - 0.5f) + y[i] * (y0 - 0.5f));
    }
  }

  [[nodiscard]] float at(int i, int px, int py) const {
    return __builtin_fmaf(y[i], static_cast<float>(py),
                          __builtin_fmaf(x[i], static_cast<float>(px), at_origin[i]));
  }
};

/// Draws clusters of one item.
class ItemDrawer {
 public:
  ItemDrawer(const KernelScene& scene, const RasterView& view, Target& target, RegionMemory& memory)
      : scene_(scene), view_(view), target_(target), memory_(memory) {}

  /// `may_be_cut`: not certainly inside the view as a whole. `mark` is for blended items: a number of this
  /// object's own.
  void begin(const Item& item, bool may_be_cut, std::int32_t mark) {
    item_ = &item;
    may_be_cut_ = may_be_cut;
    placement_ = &scene_.placements[item.object];
    mark_ = mark;
    blended_pixels_ = 0;
  }
  [[nodiscard]] std::uint32_t blended_pixels() const { return blended_pixels_; }

  /// Instead of drawing, the clusters that follow are looked at: does any of their triangles, as large as the
  /// pixels it touches, lie in front of the image? Alpha is not asked.
  /// In which blocks is added to `in_front`; beyond `enough` of them no more are looked for.
  void begin_probe(const Item& item, bool both_sides, BlockRectangle& in_front, int enough) {
    begin(item, false, 0);
    both_sides_ = both_sides;
    in_front_ = &in_front;
    enough_ = enough;
  }

  void draw(const Cluster& cluster, std::int32_t rank, bool may_clip) {
    rank_ = rank;
    const unsigned cut = transform(scene_, cluster, *placement_, view_, may_clip, vertices_);
    const std::uint8_t* corners[3];
    for (int c = 0; c < 3; ++c) corners[c] = scene_.corners[c] + cluster.first_triangle;
    if (cut == 0) {
      for (int first = 0; first < cluster.triangle_count; first += k_lanes) {
        for (int c = 0; c < 3; ++c) {
          const Ints index = load_bytes(corners[c] + first);
          store(batch_.x[c], gather(vertices_.x, index));
          store(batch_.y[c], gather(vertices_.y, index));
          store(batch_.depth[c], gather(vertices_.depth, index));
        }
        const int left = cluster.triangle_count - first;
        batch_.count = left < k_lanes ? left : k_lanes;
        if (item_->masked) {
          for (int lane = 0; lane < batch_.count; ++lane) {
            for (int c = 0; c < 3; ++c) put_uv(cluster, corners[c][first + lane], c, lane);
          }
        }
        flush();
      }
      return;
    }
    draw_cut(cluster, corners);
  }

 private:
  /// Some vertex lies outside the view: triangle by triangle.
  void draw_cut(const Cluster& cluster, const std::uint8_t* const corners[3]) {
    batch_.count = 0;
    for (int i = 0; i < cluster.triangle_count; ++i) {
      const int index[3] = {corners[0][i], corners[1][i], corners[2][i]};
      const std::int32_t a = vertices_.outside[index[0]], b = vertices_.outside[index[1]],
                         c = vertices_.outside[index[2]];
      if ((a & b & c) != 0) continue;
      if ((a | b | c) == 0) {
        for (int corner = 0; corner < 3; ++corner) {
          batch_.x[corner][batch_.count] = vertices_.x[index[corner]];
          batch_.y[corner][batch_.count] = vertices_.y[index[corner]];
          batch_.depth[corner][batch_.count] = vertices_.depth[index[corner]];
          if (item_->masked) put_uv(cluster, index[corner], corner, batch_.count);
        }
        push();
        continue;
      }
      ClippedPolygon polygon;
      clip_triangle(clip_vertex(cluster, index[0]), clip_vertex(cluster, index[1]),
                    clip_vertex(cluster, index[2]), static_cast<unsigned>(a | b | c),
                    0.5f * static_cast<float>(view_.image_width),
                    0.5f * static_cast<float>(view_.image_height), polygon);
      for (int k = 2; k < polygon.count; ++k) {
        put(polygon.corners[k - 1], 0);
        put(polygon.corners[k], 1);
        put(polygon.corners[0], 2);
        push();
      }
    }
    if (batch_.count > 0) flush();
  }

  void push() {
    if (++batch_.count < k_lanes) return;
    flush();
    batch_.count = 0;
  }

  void put_uv(const Cluster& cluster, int vertex, int corner, int lane) {
    const std::size_t at = cluster.first_vertex + static_cast<std::size_t>(vertex);
    const float one_over_w = vertices_.one_over_w[vertex];
    batch_.u[corner][lane] = scene_.u == nullptr ? 0.0f : scene_.u[at] * one_over_w;
    batch_.v[corner][lane] = scene_.v == nullptr ? 0.0f : scene_.v[at] * one_over_w;
    batch_.one_over_w[corner][lane] = one_over_w;
  }

  void put(const ClipVertex& vertex, int corner) {
    const int lane = batch_.count;
    batch_.x[corner][lane] = vertex.window[0];
    batch_.y[corner][lane] = vertex.window[1];
    batch_.depth[corner][lane] = vertex.window[2];
    const float one_over_w = 1.0f / vertex.clip[3];
    batch_.u[corner][lane] = vertex.u * one_over_w;
    batch_.v[corner][lane] = vertex.v * one_over_w;
    batch_.one_over_w[corner][lane] = one_over_w;
  }

  [[nodiscard]] ClipVertex clip_vertex(const Cluster& cluster, int index) const {
    ClipVertex vertex;
    for (int row = 0; row < 4; ++row) vertex.clip[row] = vertices_.clip[row][index];
    const std::size_t at = cluster.first_vertex + static_cast<std::size_t>(index);
    vertex.u = scene_.u == nullptr ? 0.0f : scene_.u[at];
    vertex.v = scene_.v == nullptr ? 0.0f : scene_.v[at];
    vertex.window[0] = vertices_.x[index];
    vertex.window[1] = vertices_.y[index];
    vertex.window[2] = vertices_.depth[index];
    return vertex;
  }

  void flush() {
    const bool mirrored = placement_->mirrored;
    if (in_front_ != nullptr) {
      set_up<true>(target_, batch_, item_->double_sided || both_sides_, mirrored,
                   [&](const FillTriangle& triangle, int, bool) {
                     if (in_front_->area() <= enough_) find_in_front(target_, triangle, lanes_, *in_front_);
                   });
      return;
    }
    set_up(target_, batch_, item_->double_sided, mirrored,
           [&](const FillTriangle& triangle, int lane, bool counter_clockwise) {
             if (may_be_cut_ && !item_->double_sided && !winding_survives_clipping(batch_, lane, mirrored) &&
                 item_is_cut()) {
               return;
             }
             if (item_->blended) {
               blended_pixels_ += fill_blended(target_, triangle, lanes_, mark_);
             } else if (item_->masked) {
               const UvPlane plane(batch_, lane, counter_clockwise);
               fill_masked(target_, triangle, lanes_, rank_,
                           [&](int px, int py) { return passes(plane, px, py); });
             } else {
               fill_opaque(target_, triangle, lanes_, rank_);
             }
           });
  }

  /// Whether any vertex of the whole item lies outside the view. Asked for slivers alone, and found out once
  /// an item and round.
  [[nodiscard]] bool item_is_cut() {
    std::uint32_t& known = memory_.item_cut[item_ - scene_.items];
    if (known >> 1 != memory_.round) {
      bool cut = false;
      ClusterVertices vertices;
      for (std::uint32_t i = item_->first_cluster; i < item_->end_cluster && !cut; ++i) {
        cut = transform(scene_, scene_.clusters[i], *placement_, view_, true, vertices) != 0;
      }
      known = memory_.round << 1 | (cut ? 1u : 0u);
    }
    return (known & 1u) != 0;
  }

  [[nodiscard]] bool passes(const UvPlane& plane, int px, int py) const {
    const MaskMaterial& material = scene_.mask_materials[item_->material];
    if (material.texture == k_no_texture) return material.base_alpha >= material.cutoff;
    const float w = 1.0f / plane.at(2, px, py);
    const float alpha =
        alpha_at(scene_.alpha_textures[material.texture], plane.at(0, px, py) * w, plane.at(1, px, py) * w);
    return alpha * material.base_alpha >= material.cutoff;
  }

  const KernelScene& scene_;
  const RasterView& view_;
  Target& target_;
  RegionMemory& memory_;
  const LaneOffsets lanes_;
  const Item* item_ = nullptr;
  const Placement* placement_ = nullptr;
  bool may_be_cut_ = true;
  std::int32_t rank_ = 0;
  std::int32_t mark_ = 0;
  std::uint32_t blended_pixels_ = 0;
  BlockRectangle* in_front_ = nullptr;  ///< of a probe
  bool both_sides_ = false;
  int enough_ = 0;
  ClusterVertices vertices_;
  Batch batch_;
};

}  // namespace sightline::raster::SIGHTLINE_LANES
