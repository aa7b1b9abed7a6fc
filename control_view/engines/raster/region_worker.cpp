#include "control_view/engines/raster/region_worker.hpp"

#include <algorithm>

namespace sightline::raster {

RegionWorker::RegionWorker(const RasterScene& scene, bool any_blended)
    : any_blended_(any_blended),
      drawn_in_(scene.owners.size(), 0),
      pixels_of_rank_(scene.owners.size(), 0),
      seen_ranks_(scene.owners.size(), 0),
      item_cut_(scene.items.size(), 0),
      object_drawn_in_(scene.placements.size(), 0),
      blended_candidates_(scene.placements.size(), 0),
      shown_of_rank_(scene.owners.size()),
      region_counts_(scene.owners.size() + scene.placements.size()) {
  memory_.drawn_in = drawn_in_.data();
  memory_.pixels_of_rank = pixels_of_rank_.data();
  memory_.seen_ranks = seen_ranks_.data();
  memory_.shown_of_rank = shown_of_rank_.data();
  memory_.item_cut = item_cut_.data();
  memory_.object_drawn_in = object_drawn_in_.data();
  memory_.blended_candidates = blended_candidates_.data();
  memory_.counts = region_counts_.data();
}

void RegionWorker::begin(std::size_t eyes, std::size_t blocks) {
  if (counts_.size() < eyes) {
    counts_.resize(eyes);
    open_.resize(eyes);
    seen_.resize(eyes);
  }
  for (auto& counts : counts_) counts.clear();
  for (auto& open : open_) open.clear();
  for (auto& seen : seen_) seen.clear();
  drawn_objects_ = 0;
  drawn_triangles_ = 0;

  if (block_state_.size() < blocks) {
    depth_.resize(blocks * k_block_pixels);
    rank_.resize(blocks * k_block_pixels + k_padding);
    if (any_blended_) blended_mark_.resize(blocks * k_block_pixels, 0);
    block_far_.resize(blocks + k_padding);
    block_state_.resize(blocks);
  }
  memory_.depth = depth_.data();
  memory_.rank = rank_.data();
  memory_.blended_mark = blended_mark_.data();
  memory_.block_far = block_far_.data();
  memory_.block_state = block_state_.data();
}

void RegionWorker::begin_round() {
  constexpr std::uint32_t k_last_round = 0x7fffffffu;  // item_cut holds twice a round
  if (memory_.round++ == k_last_round) {
    for (auto* rounds : {&drawn_in_, &object_drawn_in_, &item_cut_})
      std::fill(rounds->begin(), rounds->end(), 0);
    memory_.round = 1;
  }
  // Leaves room for a round that draws every object there can be.
  constexpr std::int32_t k_many_marks = 1 << 30;
  if (memory_.blended_draws > k_many_marks) {
    std::fill(blended_mark_.begin(), blended_mark_.end(), 0);
    memory_.blended_draws = 0;
  }
}

void RegionWorker::draw(const KernelFunctions& kernel, const RegionJob& job, std::size_t eye) {
  begin_round();
  const RegionResult result = kernel.draw(job, memory_);
  counts_[eye].insert(counts_[eye].end(), memory_.counts, memory_.counts + result.count_count);
  seen_[eye].insert(seen_[eye].end(), memory_.seen_ranks, memory_.seen_ranks + result.seen_count);
  drawn_objects_ += result.drawn_objects;
  drawn_triangles_ += result.drawn_triangles;
}

void RegionWorker::probe(const KernelFunctions& kernel, const ProbeJob& job, std::size_t eye) {
  begin_round();
  const RegionResult result = kernel.probe(job, memory_);
  open_[eye].insert(open_[eye].end(), memory_.counts, memory_.counts + result.count_count);
  drawn_triangles_ += result.drawn_triangles;
}

RegionResult RegionWorker::draw_image(const KernelFunctions& kernel, const RegionJob& job,
                                      OwnerImage& image) {
  begin_round();
  const RegionResult result = kernel.draw(job, memory_);
  read_owners(job.region, *job.scene, memory_, image);
  return result;
}

void RegionWorker::look_closer(const KernelFunctions& kernel, const Closeup& closeup, WholeDepth& depth,
                               std::vector<std::uint32_t>& kept) {
  RegionJob draw;
  draw.scene = closeup.scene;
  draw.view = closeup.view;
  draw.region = closeup.region;
  begin_round();
  const RegionResult shown = kernel.draw(draw, memory_);
  drawn_triangles_ += shown.drawn_triangles;
  std::vector<std::uint32_t> seen;
  for (std::uint32_t i = 0; i < shown.count_count; ++i) seen.push_back(memory_.counts[i].object);
  std::sort(seen.begin(), seen.end());
  std::vector<std::uint32_t> unseen;
  for (const std::uint32_t object : closeup.candidates) {
    (std::binary_search(seen.begin(), seen.end(), object) ? kept : unseen).push_back(object);
  }
  if (unseen.empty()) return;

  // Every closer look has room in it; what a smaller one leaves of the last lies beyond its rim.
  depth.resize({k_longest_closeup_px, k_highest_closeup_px});
  ProbeJob probe;
  probe.scene = closeup.scene;
  probe.view = closeup.view;
  probe.region = closeup.region;
  probe.image = depth.image();
  probe.image.first -= closeup.region.y * probe.image.stride + closeup.region.x;
  probe.radius = closeup.radius;
  probe.rim_blocks = 1;
  probe.both_sides = closeup.both_sides;
  probe.candidates = unseen.data();
  probe.candidate_count = static_cast<std::uint32_t>(unseen.size());
  kernel.copy_depth(closeup.region, memory_, probe.image);
  begin_round();
  const RegionResult open = kernel.probe(probe, memory_);
  drawn_triangles_ += open.drawn_triangles;
  for (std::uint32_t i = 0; i < open.count_count; ++i) kept.push_back(memory_.counts[i].object);
}

}  // namespace sightline::raster
