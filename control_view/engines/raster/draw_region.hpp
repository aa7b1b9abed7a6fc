// Included by the kernels only: SIGHTLINE_LANES names the namespace of their instruction set.
#pragma once

#include "control_view/engines/raster/draw_cluster.hpp"
#include "control_view/engines/raster/region_walk.hpp"

namespace sightline::raster::SIGHTLINE_LANES {

/// One walk over the scene for one region of a view.
class RegionDrawer : RegionWalk {
 public:
  RegionDrawer(const RegionJob& job, RegionMemory& memory)
      : RegionWalk(*job.scene, *job.view, job.region, memory),
        job_(job),
        memory_(memory),
        drawer_(*job.scene, *job.view, target_, memory) {}

  RegionResult draw() {
    draw_first(job_.first, job_.first_count);
    draw_needles();
    walk([this](const ScreenBox& box, std::uint32_t object) { draw_object(box, object); });
    count_blended();
    count_opaque();
    count_boxes();
    return take_result();
  }

 private:
  /// What showed last time.
  void draw_first(const std::uint32_t* ranks, std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const RankOwner& owner = scene_.owners[ranks[i]];
      const Item& item = scene_.items[owner.item];
      if (item.blended || is_gone(owner.object)) continue;
      enter(owner.object);
      drawer_.begin(item, true, 0);
      draw_rank(item, static_cast<std::int32_t>(ranks[i]));
    }
  }

  /// What no bounds hold. Objects with blended needles are candidates whatever hides them.
  void draw_needles() {
    for (std::uint32_t i = 0; i < job_.needle_count; ++i) {
      const Item& item = scene_.items[job_.needles[i].item];
      const ScreenBox box = screen_box(scene_.bounds[item.object]);
      if (!box.visible) continue;
      if (!item.blended) {
        drawer_.begin(item, !box.unclipped, 0);
        draw_cluster(item, job_.needles[i].cluster, item.first_rank, !box.unclipped);
      } else if (!has_blended_needles(item.object)) {
        memory_.blended_candidates[blended_count_++] = item.object;
        with_blended_needles_ = blended_count_;
      }
    }
  }
  /// Those candidates come first, and ascend as needles do.
  [[nodiscard]] bool has_blended_needles(std::uint32_t object) const {
    std::uint32_t first = 0, end = with_blended_needles_;
    while (first < end) {
      const std::uint32_t middle = (first + end) / 2;
      if (memory_.blended_candidates[middle] < object) {
        first = middle + 1;
      } else {
        end = middle;
      }
    }
    return first < with_blended_needles_ && memory_.blended_candidates[first] == object;
  }

  /// Once the opaque depth is finished.
  void count_blended() {
    for (std::uint32_t i = 0; i < blended_count_; ++i) {
      const std::uint32_t object = memory_.blended_candidates[i];
      const ScreenBox box = screen_box(scene_.bounds[object]);
      const bool has_needles = i < with_blended_needles_;
      if (!box.visible || (!has_needles && hidden(box))) continue;
      ++result_.drawn_objects;
      const std::int32_t mark = ++memory_.blended_draws;
      std::uint32_t pixels = 0;
      for (std::uint32_t item = scene_.first_item[object]; item < scene_.first_item[object + 1]; ++item) {
        if (!scene_.items[item].blended) continue;
        draw_item(scene_.items[item], box, mark);
        if (has_needles) draw_needles_of(item, !box.unclipped);
        pixels += drawer_.blended_pixels();
      }
      if (pixels > 0) add_count(object, pixels, shown_in(box));
    }
  }

  /// Of a blended item that has just been drawn.
  void draw_needles_of(std::uint32_t item, bool may_clip) {
    const std::uint32_t object = scene_.items[item].object;
    std::uint32_t first = 0, end = job_.needle_count;
    while (first < end) {
      const std::uint32_t middle = (first + end) / 2;
      if (scene_.items[job_.needles[middle].item].object < object) {
        first = middle + 1;
      } else {
        end = middle;
      }
    }
    for (std::uint32_t i = first; i < job_.needle_count; ++i) {
      if (scene_.items[job_.needles[i].item].object != object) break;
      if (job_.needles[i].item != item) continue;
      draw_cluster(scene_.items[item], job_.needles[i].cluster, 0, may_clip);
    }
  }

  void count_opaque() {
    for (int block = 0; block < target_.blocks_x * target_.blocks_y; ++block) {
      if (!target_.untouched(block)) count_block(block);
    }
  }

  void count_boxes() {
    for (std::uint32_t i = 0; i < job_.box_count; ++i) {
      const ScreenBox box = screen_box(job_.boxes[i].box);
      if (box.visible && !hidden(box)) add_count(job_.boxes[i].object, 1, shown_in(box));
    }
  }

  RegionResult take_result() {
    for (std::uint32_t i = 0; i < result_.seen_count; ++i) {
      std::uint32_t& pixels = memory_.pixels_of_rank[memory_.seen_ranks[i]];
      add_count(scene_.owners[memory_.seen_ranks[i]].object, pixels,
                memory_.shown_of_rank[memory_.seen_ranks[i]]);
      pixels = 0;
    }
    return result_;
  }

  void draw_object(const ScreenBox& box, std::uint32_t object) {
    if (hidden(box)) return;
    if (scene_.has_blended[object] != 0 && !has_blended_needles(object))
      memory_.blended_candidates[blended_count_++] = object;
    if (scene_.has_opaque[object] == 0) return;
    for (std::uint32_t item = scene_.first_item[object]; item < scene_.first_item[object + 1]; ++item) {
      if (!scene_.items[item].blended) draw_item(scene_.items[item], box, 0);
    }
  }

  void draw_item(const Item& item, const ScreenBox& object_box, std::int32_t mark) {
    drawer_.begin(item, !object_box.unclipped, mark);
    if (item.end_cluster - item.first_cluster == 1) {
      // Its box is the object's, or not much smaller.
      if (item.blended || begin_rank(item.first_rank)) {
        draw_cluster(item, item.first_cluster, item.first_rank, !object_box.unclipped);
      }
      return;
    }
    enter(item.object);
    if (item.blended) return draw_clusters(item, item.first_cluster, item.end_cluster, item.first_rank);
    const std::uint32_t last = (item.end_cluster - item.first_cluster - 1) >> scene_.rank_shift;
    for (std::uint32_t part = 0; part <= last; ++part) {
      draw_rank(item, item.first_rank + static_cast<std::int32_t>(part));
    }
  }

  void draw_rank(const Item& item, std::int32_t rank) {
    if (!begin_rank(rank)) return;
    const std::uint32_t first = scene_.owners[rank].first_cluster;
    const std::uint32_t most = std::uint32_t{1} << scene_.rank_shift;
    draw_clusters(item, first, item.end_cluster - first < most ? item.end_cluster : first + most, rank);
  }

  /// Whether the rank is still to be drawn in this round. What is hidden now stays so, and is not asked about
  /// again.
  bool begin_rank(std::int32_t rank) {
    if (memory_.drawn_in[rank] == memory_.round) return false;
    memory_.drawn_in[rank] = memory_.round;
    return true;
  }

  /// Those that are not hidden.
  void draw_clusters(const Item& item, std::uint32_t first, std::uint32_t end, std::int32_t rank) {
    for (std::uint32_t cluster = first; cluster < end; ++cluster) {
      const ScreenBox box = screen_box_of(scene_.clusters[cluster].box, object_view_, target_);
      if (box.visible && !hidden(box)) draw_cluster(item, cluster, rank, !box.unclipped);
    }
  }

  void draw_cluster(const Item& item, std::uint32_t cluster, std::int32_t rank, bool may_clip) {
    if (!item.blended && memory_.object_drawn_in[item.object] != memory_.round) {
      memory_.object_drawn_in[item.object] = memory_.round;
      ++result_.drawn_objects;
    }
    drawer_.draw(scene_.clusters[cluster], rank, may_clip);
    result_.drawn_triangles += scene_.clusters[cluster].triangle_count;
  }

  void add_count(std::uint32_t object, std::uint32_t pixels, const ShownIn& shown) {
    memory_.counts[result_.count_count++] = {object, pixels, shown};
  }

  void count_block(int block) {
    const std::int32_t* const ranks = target_.rank + block * k_block_pixels;
    const ShownIn here = shown_in_block(block);
    std::uint64_t ends = 0;  // bit i: pixel i + 1 has another rank than pixel i
    for (int i = 0; i < k_block_pixels; i += k_lanes) {
      ends |= std::uint64_t{bits(!(load(ranks + i) == load(ranks + i + 1))) & k_every_lane} << i;
    }
    ends &= ~(std::uint64_t{1} << (k_block_pixels - 1));  // what follows the last pixel is another block's
    int start = 0;
    for (; ends != 0; ends &= ends - 1) {
      const int end = __builtin_ctzll(ends) + 1;
      add_run(ranks[start], end - start, here);
      start = end;
    }
    add_run(ranks[start], k_block_pixels - start, here);
  }

  [[nodiscard]] ShownIn shown_in_block(int block) const {
    const float* const depth = target_.depth + block * k_block_pixels;
    Floats negative_nearest = all(0.0f);
    // Pixels outside the region are nearer than anything.
    for (int i = 0; i < k_block_pixels; i += k_lanes) {
      const Floats d = load(depth + i);
      negative_nearest = min(negative_nearest, select(d > all(1.0f), all(0.0f), all(0.0f) - d));
    }
    const int left = target_.x0 + block % target_.blocks_x * k_block;
    const int bottom = target_.y0 + block / target_.blocks_x * k_block;
    return {left, bottom, left + k_block - 1, bottom + k_block - 1, -least(negative_nearest)};
  }

  void add_run(std::int32_t rank, int pixels, const ShownIn& here) {
    if (rank == 0) return;
    std::uint32_t& sum = memory_.pixels_of_rank[rank];
    ShownIn& shown = memory_.shown_of_rank[rank];
    if (sum == 0) {
      memory_.seen_ranks[result_.seen_count++] = static_cast<std::uint32_t>(rank);
      shown = here;
    } else {
      // Blocks come row by row from the bottom.
      if (here.left < shown.left) shown.left = here.left;
      if (here.right > shown.right) shown.right = here.right;
      if (here.top > shown.top) shown.top = here.top;
      if (here.nearest > shown.nearest) shown.nearest = here.nearest;
    }
    sum += static_cast<std::uint32_t>(pixels);
  }

  static constexpr unsigned k_every_lane = (1u << k_lanes) - 1u;

  const RegionJob& job_;
  RegionMemory& memory_;
  ItemDrawer drawer_;
  std::uint32_t blended_count_ = 0;
  std::uint32_t with_blended_needles_ = 0;  ///< of blended_candidates, the first ones
  RegionResult result_{};
};

}  // namespace sightline::raster::SIGHTLINE_LANES
