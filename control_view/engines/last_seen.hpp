#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sightline {

/// What each eye of each viewer (see viewer_of) saw last, as an engine's items (objects, parts of objects). A
/// hint: whatever it says, the answer stays exact. Bounded: of more eyes than k_max_eyes the one asked about
/// longest ago is forgotten.
template <class Item>
class LastSeen {
 public:
  static constexpr std::size_t k_max_eyes = 256;

  /// The items of one eye, to read and to replace; empty for one not seen before. Valid until the next call.
  [[nodiscard]] std::vector<Item>& of(std::uint64_t viewer, std::size_t eye) {
    ++uses_;
    auto entry = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& candidate) {
      return candidate.viewer == viewer && candidate.eye == eye;
    });
    if (entry == entries_.end()) {
      if (entries_.size() < k_max_eyes) {
        entry = entries_.insert(entries_.end(), Entry{});
      } else {
        entry = std::min_element(entries_.begin(), entries_.end(),
                                 [](const Entry& a, const Entry& b) { return a.last_use < b.last_use; });
        entry->items.clear();
      }
      entry->viewer = viewer;
      entry->eye = eye;
    }
    entry->last_use = uses_;
    return entry->items;
  }

 private:
  struct Entry {
    std::uint64_t viewer = 0;
    std::size_t eye = 0;
    std::uint64_t last_use = 0;
    std::vector<Item> items;
  };

  std::vector<Entry> entries_;
  std::uint64_t uses_ = 0;
};

}  // namespace sightline
