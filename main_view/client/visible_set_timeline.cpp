#include "main_view/client/visible_set_timeline.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace sightline {
namespace {

constexpr auto k_is_before = [](const FiledSet& filed, double time_s) {
  return filed.request.for_time_s < time_s;
};
constexpr auto k_is_after = [](double time_s, const FiledSet& filed) {
  return time_s < filed.request.for_time_s;
};

}  // namespace

void VisibleSetTimeline::file(ViewRequest request, VisibleSet set) {
  const auto at = std::lower_bound(sets_.begin(), sets_.end(), request.for_time_s, k_is_before);
  const bool same_time = at != sets_.end() && at->request.for_time_s == request.for_time_s;
  if (same_time && request.request_seq <= at->request.request_seq) return;
  SeenSet seen(set);
  std::vector<TestedEye> tested;
  tested.reserve(request.eyes.size());
  for (const Eye& eye : request.eyes) tested.emplace_back(eye, request.rotation_error_rad);
  FiledSet filed{std::move(request), std::move(set), std::move(seen), std::move(tested)};
  if (same_time) {
    *at = std::move(filed);
    return;
  }
  sets_.insert(at, std::move(filed));
  if (sets_.size() > capacity_) sets_.erase(sets_.begin());
}

void VisibleSetTimeline::drop_before(double time_s) {
  const auto kept = std::lower_bound(sets_.begin(), sets_.end(), time_s, k_is_before);
  for (auto set = sets_.begin(); set != kept; ++set) keep_boxes(*set);
  sets_.erase(sets_.begin(), kept);
}

/// Ten thousand boxes are half a megabyte: given back in every frame, it would come as untouched pages again.
void VisibleSetTimeline::keep_boxes(FiledSet& forgotten) noexcept {
  std::vector<BoxedObject>& boxes = forgotten.request.boxed;
  if (boxes.capacity() <= spare_boxes_.capacity()) return;
  boxes.clear();
  spare_boxes_.swap(boxes);
}

const FiledSet* VisibleSetTimeline::last_at_or_before(double now_s) const noexcept {
  const auto after = std::upper_bound(sets_.begin(), sets_.end(), now_s, k_is_after);
  return after == sets_.begin() ? nullptr : &*std::prev(after);
}

const FiledSet* VisibleSetTimeline::next_after(double now_s) const noexcept {
  const auto after = std::upper_bound(sets_.begin(), sets_.end(), now_s, k_is_after);
  return after == sets_.end() ? nullptr : &*after;
}

std::span<const FiledSet> VisibleSetTimeline::all_after(double now_s) const noexcept {
  const auto after = std::upper_bound(sets_.begin(), sets_.end(), now_s, k_is_after);
  return std::span(sets_).subspan(static_cast<std::size_t>(after - sets_.begin()));
}

std::optional<std::uint64_t> VisibleSetTimeline::lowest_request_seq(double from_s) const noexcept {
  std::optional<std::uint64_t> lowest;
  for (const FiledSet& filed : sets_) {
    if (filed.request.for_time_s < from_s) continue;
    const std::uint64_t seq = filed.request.request_seq;
    lowest = std::min(lowest.value_or(seq), seq);
  }
  return lowest;
}

}  // namespace sightline
