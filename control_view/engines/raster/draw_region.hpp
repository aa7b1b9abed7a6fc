// Included by the kernels only: SIGHTLINE_LANES names the namespace of their instruction set.
#pragma once

#include "control_view/engines/raster/draw_cluster.hpp"

namespace sightline::raster::SIGHTLINE_LANES {

/// One walk over the scene for one region of a view.
class RegionDrawer {
 public:
  RegionDrawer(const RegionJob& job, RegionMemory& memory)
      : job_(job),
        scene_(*job.scene),
        memory_(memory),
        target_(job.region, memory),
        drawer_(*job.scene, *job.view, target_, memory) {
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 4; ++row) {
        view_.clip_from_box[column][row] = job.view->clip_from_scene[column][row];
        view_.magnitude[column][row] = __builtin_fabsf(job.view->clip_from_scene[column][row]);
      }
    }
    view_.half_width = 0.5f * static_cast<float>(job.view->image_width);
    view_.half_height = 0.5f * static_cast<float>(job.view->image_height);
  }

  RegionResult draw() {
    draw_first(job_.first, job_.first_count);
    draw_rest();
    count_blended();
    count_opaque();
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

  /// Everything else that may show, front to back.
  void draw_rest() {
    if (scene_.nodes == nullptr) return;
    Candidate stack[ObjectHierarchy::k_max_depth + 2];
    int depth = 0;
    push_if_visible(0, stack, depth);
    while (depth > 0) {
      const Candidate next = stack[--depth];
      if (hidden(next.box)) continue;
      const ObjectHierarchy::Node& node = scene_.nodes[next.index];
      if (node.right == 0) {
        draw_leaf(node);
        continue;
      }
      const int before = depth;
      push_if_visible(next.index + 1, stack, depth);
      push_if_visible(node.right, stack, depth);
      if (depth == before + 2 && stack[depth - 1].box.nearest < stack[depth - 2].box.nearest) {
        const Candidate farther = stack[depth - 1];
        stack[depth - 1] = stack[depth - 2];
        stack[depth - 2] = farther;
      }
    }
  }

  /// Once the opaque depth is finished.
  void count_blended() {
    for (std::uint32_t i = 0; i < blended_count_; ++i) {
      const std::uint32_t object = memory_.blended_candidates[i];
      const ScreenBox box = screen_box(scene_.bounds[object]);
      if (!box.visible || hidden(box)) continue;
      ++result_.drawn_objects;
      const std::int32_t mark = ++memory_.blended_draws;
      std::uint32_t pixels = 0;
      for (std::uint32_t item = scene_.first_item[object]; item < scene_.first_item[object + 1]; ++item) {
        if (!scene_.items[item].blended) continue;
        draw_item(scene_.items[item], box, mark);
        pixels += drawer_.blended_pixels();
      }
      if (pixels > 0) add_count(object, pixels);
    }
  }

  void count_opaque() {
    for (int block = 0; block < target_.blocks_x * target_.blocks_y; ++block) {
      if (!target_.untouched(block)) count_block(target_.rank + block * k_block_pixels);
    }
  }

  RegionResult take_result() {
    for (std::uint32_t i = 0; i < result_.seen_count; ++i) {
      std::uint32_t& pixels = memory_.pixels_of_rank[memory_.seen_ranks[i]];
      add_count(scene_.owners[memory_.seen_ranks[i]].object, pixels);
      pixels = 0;
    }
    return result_;
  }

  /// A node or an object, by its index.
  struct Candidate {
    ScreenBox box;
    std::uint32_t index = 0;
  };

  [[nodiscard]] ScreenBox screen_box(const Aabb& box) const {
    // An empty box is an object that is not there.
    return box.min.x > box.max.x ? ScreenBox{} : screen_box_of(box, view_, target_);
  }
  bool hidden(const ScreenBox& box) {
    return target_.hides_rectangle(box.left, box.bottom, box.right, box.top, box.nearest);
  }

  void push_if_visible(std::uint32_t index, Candidate* stack, int& depth) {
    const ScreenBox box = screen_box(scene_.nodes[index].box);
    if (!box.visible || hidden(box)) return;
    stack[depth++] = {box, index};
  }

  void draw_leaf(const ObjectHierarchy::Node& leaf) {
    Candidate objects[k_most_at_once];
    int count = 0;
    const auto draw_all = [&] {
      for (int i = 0; i < count; ++i) draw_object(objects[i].box, objects[i].index);
      count = 0;
    };
    for (std::uint32_t slot = leaf.first_slot; slot < leaf.end_slot; ++slot) {
      const auto object = static_cast<std::uint32_t>(scene_.slots[slot]);
      const ScreenBox box = screen_box(scene_.bounds[object]);
      if (!box.visible || hidden(box)) continue;
      if (count == k_most_at_once) draw_all();
      int at = count++;
      for (; at > 0 && objects[at - 1].box.nearest < box.nearest; --at) objects[at] = objects[at - 1];
      objects[at] = {box, object};
    }
    draw_all();
  }

  void draw_object(const ScreenBox& box, std::uint32_t object) {
    if (hidden(box)) return;
    if (scene_.has_blended[object] != 0) memory_.blended_candidates[blended_count_++] = object;
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

  [[nodiscard]] bool is_gone(std::uint32_t object) const {
    return scene_.bounds[object].min.x > scene_.bounds[object].max.x;
  }

  /// Makes object_view_ that of the object's mesh.
  void enter(std::uint32_t object) {
    if (object == object_of_view_) return;
    object_of_view_ = object;
    object_view_ = view_of(scene_.placements[object]);
  }

  /// For boxes in the frame of a mesh.
  [[nodiscard]] BoxView view_of(const Placement& placement) const {
    if (placement.identity) return view_;
    BoxView view = view_;
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 4; ++row) {
        float sum = column == 3 ? view_.clip_from_box[3][row] : 0.0f;
        float magnitude = column == 3 ? view_.magnitude[3][row] : 0.0f;
        for (int i = 0; i < 3; ++i) {
          sum += view_.clip_from_box[i][row] * placement.columns[column][i];
          magnitude += view_.magnitude[i][row] * __builtin_fabsf(placement.columns[column][i]);
        }
        view.clip_from_box[column][row] = sum;
        view.magnitude[column][row] = magnitude;
      }
    }
    return view;
  }

  void add_count(std::uint32_t object, std::uint32_t pixels) {
    memory_.counts[result_.count_count++] = {object, pixels};
  }

  void count_block(const std::int32_t* ranks) {
    std::uint64_t ends = 0;  // bit i: pixel i + 1 has another rank than pixel i
    for (int i = 0; i < k_block_pixels; i += k_lanes) {
      ends |= std::uint64_t{bits(!(load(ranks + i) == load(ranks + i + 1))) & k_every_lane} << i;
    }
    ends &= ~(std::uint64_t{1} << (k_block_pixels - 1));  // what follows the last pixel is another block's
    int start = 0;
    for (; ends != 0; ends &= ends - 1) {
      const int end = __builtin_ctzll(ends) + 1;
      add_run(ranks[start], end - start);
      start = end;
    }
    add_run(ranks[start], k_block_pixels - start);
  }

  void add_run(std::int32_t rank, int pixels) {
    if (rank == 0) return;
    std::uint32_t& sum = memory_.pixels_of_rank[rank];
    if (sum == 0) memory_.seen_ranks[result_.seen_count++] = static_cast<std::uint32_t>(rank);
    sum += static_cast<std::uint32_t>(pixels);
  }

  static constexpr int k_most_at_once = 8;
  static constexpr unsigned k_every_lane = (1u << k_lanes) - 1u;

  const RegionJob& job_;
  const KernelScene& scene_;
  RegionMemory& memory_;
  Target target_;
  ItemDrawer drawer_;
  BoxView view_;
  BoxView object_view_;
  std::uint32_t object_of_view_ = 0xffffffffu;
  std::uint32_t blended_count_ = 0;
  RegionResult result_{};
};

}  // namespace sightline::raster::SIGHTLINE_LANES
