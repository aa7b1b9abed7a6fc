#include "main_view/client/placed_bounds.hpp"

#include <algorithm>

namespace sightline {

PlacedBounds::PlacedBounds(std::span<const Aabb> bounds)
    : bounds_(bounds.begin(), bounds.end()), hierarchy_(bounds), placed_in_(bounds.size(), 0) {}

void PlacedBounds::place(ObjectId id, const Aabb& bounds) {
  bounds_[index_of(id)] = bounds;
  std::uint32_t& placed_in = placed_in_[index_of(id)];
  if (placed_in == 0) loose_.push_back(id);
  placed_in = frame_;
}

void PlacedBounds::settle() {
  ++frame_;
  if (loose_.empty()) return;
  // A few of the list each time, all of it in turn.
  std::vector<ObjectId> rested;
  std::vector<Aabb> boxes;
  const std::size_t looks = std::min(loose_.size(), 4 * k_most_settled_a_frame);
  std::size_t at = frame_ * looks % loose_.size();
  for (std::size_t look = 0; look < looks && rested.size() < k_most_settled_a_frame && !loose_.empty();
       ++look) {
    at %= loose_.size();
    const ObjectId id = loose_[at];
    if (frame_ - placed_in_[index_of(id)] < k_rest_frames) {
      ++at;
      continue;
    }
    rested.push_back(id);
    boxes.push_back(bounds_of(id));
    placed_in_[index_of(id)] = 0;
    loose_[at] = loose_.back();
    loose_.pop_back();
  }
  if (!rested.empty()) hierarchy_.move(rested, boxes);
}

}  // namespace sightline
