#include "control_view/low_pass_filter.hpp"

#include <algorithm>

namespace sightline {

LowPassFilter::LowPassFilter(std::uint32_t length) : answers_(std::clamp(length, 1u, k_max_length)) {}

void LowPassFilter::add(const PixelCounts& counts) {
  PixelCounts& slot = answers_[next_];
  if (answer_count_ == answers_.size()) sums_.subtract(slot);
  slot.ids.assign(counts.ids.begin(), counts.ids.end());
  slot.pixels.assign(counts.pixels.begin(), counts.pixels.end());
  sums_.add(slot);
  answer_count_ = std::min<std::uint32_t>(answer_count_ + 1, static_cast<std::uint32_t>(answers_.size()));
  next_ = (next_ + 1) % static_cast<std::uint32_t>(answers_.size());
}

void LowPassFilter::reset() noexcept {
  sums_.clear();
  next_ = 0;
  answer_count_ = 0;
}

MeanPixels LowPassFilter::means() const noexcept {
  return {sums_.ids(), sums_.sums(), answer_count_ == 0 ? 1.0 : 1.0 / answer_count_};
}

}  // namespace sightline
