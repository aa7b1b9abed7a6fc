// Included by the kernels only: SIGHTLINE_LANES names the namespace of their instruction set.
#pragma once

#include "control_view/engines/raster/draw_cluster.hpp"
#include "control_view/engines/raster/erode.hpp"
#include "control_view/engines/raster/region_walk.hpp"

namespace sightline::raster::SIGHTLINE_LANES {

/// Finds what a region did not show but cannot be said to hide: see OpenObject.
class RegionProber : RegionWalk {
 public:
  RegionProber(const ProbeJob& job, RegionMemory& memory)
      : RegionWalk(*job.scene, *job.view, job.region, memory),
        job_(job),
        memory_(memory),
        drawer_(*job.scene, *job.view, target_, memory) {
    Eroder(target_, job).erode(memory);
  }

  RegionResult probe() {
    if (job_.candidates == nullptr) {
      walk([this](const ScreenBox& box, std::uint32_t object) { probe_object(box, object); });
      return result_;
    }
    for (std::uint32_t i = 0; i < job_.candidate_count; ++i) {
      const std::uint32_t object = job_.candidates[i];
      const ScreenBox box = screen_box(scene_.bounds[object]);
      if (box.visible) probe_object(box, object);
    }
    return result_;
  }

 private:
  void probe_object(const ScreenBox& box, std::uint32_t object) {
    if ((job_.known != nullptr && job_.known[object] != 0) || hidden(box)) return;
    BlockRectangle open;
    for (std::uint32_t i = scene_.first_item[object]; i < scene_.first_item[object + 1]; ++i) {
      probe_item(scene_.items[i], box, open);
      if (open.area() > job_.enough_blocks) break;
    }
    if (open.empty()) return;
    const bool all_found = open.area() <= job_.enough_blocks;
    memory_.counts[result_.count_count++] = {object, static_cast<std::uint32_t>(open.area()),
                                             all_found ? shown_in(open, box) : shown_in(box)};
  }

  void probe_item(const Item& item, const ScreenBox& object_box, BlockRectangle& open) {
    enter(item.object);
    drawer_.begin_probe(item, job_.both_sides, open, job_.enough_blocks);
    for (std::uint32_t cluster = item.first_cluster; cluster < item.end_cluster; ++cluster) {
      ScreenBox box = object_box;
      if (item.end_cluster - item.first_cluster > 1) {
        box = screen_box_of(scene_.clusters[cluster].box, object_view_, target_);
        if (!box.visible || hidden(box)) continue;
      }
      result_.drawn_triangles += scene_.clusters[cluster].triangle_count;
      drawer_.draw(scene_.clusters[cluster], 0, !box.unclipped);
      if (open.area() > job_.enough_blocks) return;
    }
  }

  [[nodiscard]] ShownIn shown_in(const BlockRectangle& blocks, const ScreenBox& box) const {
    return {target_.x0 + blocks.left * k_block, target_.y0 + blocks.bottom * k_block,
            target_.x0 + blocks.right * k_block + k_block - 1,
            target_.y0 + blocks.top * k_block + k_block - 1, box.nearest};
  }
  using RegionWalk::shown_in;

  const ProbeJob& job_;
  RegionMemory& memory_;
  ItemDrawer drawer_;
  RegionResult result_{};
};

}  // namespace sightline::raster::SIGHTLINE_LANES
