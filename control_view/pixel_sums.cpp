#include "control_view/pixel_sums.hpp"

#include <algorithm>

namespace sightline {

double mean_of(const MeanPixels& means, ObjectId id) noexcept {
  const auto at = std::lower_bound(means.ids.begin(), means.ids.end(), id);
  if (at == means.ids.end() || *at != id) return 0.0;
  return means.mean(static_cast<std::size_t>(at - means.ids.begin()));
}

void PixelSums::add(const PixelCounts& counts) {
  scratch_ids_.resize(ids_.size() + counts.ids.size());
  scratch_sums_.resize(scratch_ids_.size());
  std::size_t kept = 0;
  const auto keep = [&](ObjectId id, std::uint64_t sum) {
    scratch_ids_[kept] = id;
    scratch_sums_[kept++] = sum;
  };

  std::size_t held = 0;
  for (std::size_t given = 0; given < counts.ids.size(); ++given) {
    const ObjectId id = counts.ids[given];
    for (; held < ids_.size() && ids_[held] < id; ++held) keep(ids_[held], sums_[held]);
    const bool known = held < ids_.size() && ids_[held] == id;
    keep(id, counts.pixels[given] + (known ? sums_[held] : 0));
    if (known) ++held;
  }
  for (; held < ids_.size(); ++held) keep(ids_[held], sums_[held]);
  scratch_ids_.resize(kept);
  scratch_sums_.resize(kept);
  ids_.swap(scratch_ids_);
  sums_.swap(scratch_sums_);
}

void PixelSums::subtract(const PixelCounts& counts) {
  std::size_t given = 0;
  std::size_t kept = 0;
  for (std::size_t held = 0; held < ids_.size(); ++held) {
    while (given < counts.ids.size() && counts.ids[given] < ids_[held]) ++given;
    std::uint64_t sum = sums_[held];
    if (given < counts.ids.size() && counts.ids[given] == ids_[held]) {
      sum -= std::min<std::uint64_t>(sum, counts.pixels[given]);
    }
    if (sum == 0) continue;
    ids_[kept] = ids_[held];
    sums_[kept] = sum;
    ++kept;
  }
  ids_.resize(kept);
  sums_.resize(kept);
}

void PixelSums::clear() noexcept {
  ids_.clear();
  sums_.clear();
}

}  // namespace sightline
