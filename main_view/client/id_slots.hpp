#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "common/object_id.hpp"

namespace sightline {

/// Which slot of some arrays an object has. Two loads to find one; memory by pages, so that a few high ids
/// cost little (8 bytes for each 4,096 ids below the highest, and a page of 16 KiB where there are any).
class IdSlots {
 public:
  static constexpr std::uint32_t k_none = std::numeric_limits<std::uint32_t>::max();

  [[nodiscard]] std::uint32_t find(ObjectId id) const noexcept {
    const std::size_t page = index_of(id) / k_page_ids;
    if (page >= pages_.size() || pages_[page] == nullptr) return k_none;
    return (*pages_[page])[index_of(id) % k_page_ids];
  }
  void set(ObjectId id, std::uint32_t slot) {
    const std::size_t page = index_of(id) / k_page_ids;
    if (page >= pages_.size()) pages_.resize(page + 1);
    if (pages_[page] == nullptr) {
      pages_[page] = std::make_unique<Page>();
      pages_[page]->fill(k_none);
    }
    (*pages_[page])[index_of(id) % k_page_ids] = slot;
  }

 private:
  static constexpr std::uint32_t k_page_ids = 4096;
  using Page = std::array<std::uint32_t, k_page_ids>;
  std::vector<std::unique_ptr<Page>> pages_;
};

}  // namespace sightline
