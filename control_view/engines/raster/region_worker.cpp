#include "control_view/engines/raster/region_worker.hpp"

#include <algorithm>

namespace sightline::raster {

RegionWorker::RegionWorker(std::uint32_t object_count, std::size_t rank_count, bool any_blended)
    : any_blended_(any_blended),
      drawn_in_(rank_count, 0),
      pixels_of_rank_(rank_count, 0),
      seen_ranks_(rank_count, 0),
      object_drawn_in_(object_count, 0),
      blended_candidates_(object_count, 0),
      pixels_of_object_(object_count, 0),
      region_counts_(object_count) {
  memory_.drawn_in = drawn_in_.data();
  memory_.pixels_of_rank = pixels_of_rank_.data();
  memory_.seen_ranks = seen_ranks_.data();
  memory_.object_drawn_in = object_drawn_in_.data();
  memory_.blended_candidates = blended_candidates_.data();
  memory_.pixels_of_object = pixels_of_object_.data();
  memory_.counts = region_counts_.data();
}

void RegionWorker::begin(std::size_t eyes) {
  if (counts_.size() < eyes) {
    counts_.resize(eyes);
    seen_.resize(eyes);
  }
  for (auto& counts : counts_) counts.clear();
  for (auto& seen : seen_) seen.clear();
  drawn_objects_ = 0;
  drawn_triangles_ = 0;
}

void RegionWorker::make_room(const RasterRegion& region) {
  const auto blocks = static_cast<std::size_t>((region.width + k_block - 1) / k_block) *
                      static_cast<std::size_t>((region.height + k_block - 1) / k_block);
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
  if (++memory_.round == 0) {
    for (auto* rounds : {&drawn_in_, &object_drawn_in_}) std::fill(rounds->begin(), rounds->end(), 0);
    memory_.round = 1;
  }
  constexpr std::int32_t many_marks = 1
                                      << 30;  // leaves room for a frame that draws every object there can be
  if (memory_.blended_draws > many_marks) {
    std::fill(blended_mark_.begin(), blended_mark_.end(), 0);
    memory_.blended_draws = 0;
  }
}

void RegionWorker::draw(DrawRegion kernel, const RegionJob& job, std::size_t eye) {
  make_room(job.region);
  const RegionResult result = kernel(job, memory_);
  counts_[eye].insert(counts_[eye].end(), memory_.counts, memory_.counts + result.count_count);
  seen_[eye].insert(seen_[eye].end(), memory_.seen_ranks, memory_.seen_ranks + result.seen_count);
  drawn_objects_ += result.drawn_objects;
  drawn_triangles_ += result.drawn_triangles;
}

}  // namespace sightline::raster
