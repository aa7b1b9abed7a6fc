#include "main_view/client/session_sets.hpp"

#include <algorithm>

namespace sightline {

std::optional<VisibleSet> SessionSets::decode(const VisibleSetFrame& frame, std::uint32_t object_count) {
  if (frame.set_seq <= newest_seq_) return {};
  const VisibleSet* base = nullptr;
  if (frame.base_seq != 0) {
    const auto held = std::find_if(held_.begin(), held_.end(),
                                   [&](const auto& numbered) { return numbered.first == frame.base_seq; });
    if (held == held_.end()) {
      keyframe_needed_ = true;
      return {};
    }
    base = &held->second;
  }
  auto decoded = decode_visible_set(frame, base, object_count);
  auto* set = std::get_if<VisibleSet>(&decoded);
  if (set == nullptr) {
    keyframe_needed_ = true;
    return {};
  }
  keyframe_needed_ = false;
  newest_seq_ = frame.set_seq;
  held_.emplace_back(frame.set_seq, *set);
  if (held_.size() > k_held) held_.pop_front();
  return std::move(*set);
}

void RequestsInFlight::add(ViewRequest request, double issued_s) {
  entries_.push_back({std::move(request), issued_s});
  if (entries_.size() > k_held) entries_.pop_front();
}

std::optional<RequestsInFlight::Entry> RequestsInFlight::take(std::uint64_t request_seq) {
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.request.request_seq == request_seq;
  });
  if (found == entries_.end()) return {};
  Entry entry = std::move(*found);
  entries_.erase(entries_.begin(), std::next(found));
  return entry;
}

}  // namespace sightline
