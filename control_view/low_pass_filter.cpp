#include "control_view/low_pass_filter.hpp"

#include <algorithm>

#include <glm/geometric.hpp>

namespace sightline {

LowPassFilter::LowPassFilter(std::uint32_t length) : answers_(std::clamp(length, 1u, k_max_length)) {}

void LowPassFilter::add(const PixelCounts& counts, const glm::dvec3& eye_m) {
  HeldAnswer& slot = answers_[next_];
  if (answer_count_ == answers_.size()) sums_.subtract(slot.counts);
  slot.counts.ids.assign(counts.ids.begin(), counts.ids.end());
  slot.counts.pixels.assign(counts.pixels.begin(), counts.pixels.end());
  slot.counts.extents.assign(counts.extents.begin(), counts.extents.end());
  slot.eye_m = eye_m;
  sums_.add(slot.counts);
  answer_count_ = std::min<std::uint32_t>(answer_count_ + 1, static_cast<std::uint32_t>(answers_.size()));
  next_ = (next_ + 1) % static_cast<std::uint32_t>(answers_.size());
}

void LowPassFilter::reset() noexcept {
  sums_.clear();
  next_ = 0;
  answer_count_ = 0;
}

void LowPassFilter::extents_of(std::span<const ObjectId> ids, const glm::dvec3& eye_m,
                               std::vector<DirectionExtent>& extents) const {
  extents.assign(ids.size(), k_seen_anywhere);
  std::vector<bool> seen(ids.size(), false);
  for (std::uint32_t answer = 0; answer < answer_count_; ++answer) {
    const PixelCounts& counts = answers_[answer].counts;
    const double offset_m = glm::length(answers_[answer].eye_m - eye_m);
    std::size_t at = 0;
    for (std::size_t i = 0; i < counts.ids.size(); ++i) {
      while (at < ids.size() && ids[at] < counts.ids[i]) ++at;
      if (at == ids.size()) break;
      if (ids[at] != counts.ids[i]) continue;
      const DirectionExtent extent =
          counts.extents.empty() ? k_seen_anywhere : seen_from_nearby(counts.extents[i], offset_m);
      extents[at] = seen[at] ? united(extents[at], extent) : extent;
      seen[at] = true;
    }
  }
}

std::uint32_t LowPassFilter::newest_pixels_of(ObjectId id) const noexcept {
  if (answer_count_ == 0) return 0;
  const PixelCounts& counts = answers_[(next_ + answers_.size() - 1) % answers_.size()].counts;
  const auto at = std::lower_bound(counts.ids.begin(), counts.ids.end(), id);
  if (at == counts.ids.end() || *at != id) return 0;
  return counts.pixels[static_cast<std::size_t>(at - counts.ids.begin())];
}

MeanPixels LowPassFilter::means() const noexcept {
  return {sums_.ids(), sums_.sums(), answer_count_ == 0 ? 1.0 : 1.0 / answer_count_};
}

}  // namespace sightline
