#include "control_view/sent_sets.hpp"

#include <utility>

namespace sightline {

std::uint64_t SentSets::add(VisibleSet set) {
  if (sets_.size() == k_capacity) {
    sets_.pop_front();
    ++first_seq_;
  }
  sets_.push_back(std::move(set));
  return first_seq_ + sets_.size() - 1;
}

const VisibleSet* SentSets::find(std::uint64_t set_seq) const noexcept {
  if (set_seq < first_seq_ || set_seq - first_seq_ >= sets_.size()) return nullptr;
  return &sets_[set_seq - first_seq_];
}

void SentSets::acknowledge(std::uint64_t set_seq) {
  if (find(set_seq) == nullptr) return;
  while (first_seq_ < set_seq) {
    sets_.pop_front();
    ++first_seq_;
  }
}

}  // namespace sightline
