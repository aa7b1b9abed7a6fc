#include "common/sort_object_ids.hpp"

#include <algorithm>
#include <bit>

namespace sightline {

void sort_object_ids(std::vector<ObjectId>& ids, std::uint32_t object_count) {
  const std::size_t count = ids.size();
  const std::size_t word_count = (std::size_t{object_count} + 31) / 32;
  // Sweeping a word costs about as much as a comparison or two of std::sort.
  if (count < 64 || count * 8 < word_count) {
    std::sort(ids.begin(), ids.end());
    return;
  }
  ids.resize(count + word_count, ObjectId{0});
  ObjectId* const words = ids.data() + count;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t index = index_of(ids[i]);
    ObjectId& word = words[index / 32];
    word = ObjectId{index_of(word) | (1u << (index % 32))};
  }
  ObjectId* next = ids.data();
  for (std::size_t i = 0; i < word_count; ++i) {
    std::uint32_t word = index_of(words[i]);
    const auto base = static_cast<std::uint32_t>(32 * i);
    for (; word != 0; word &= word - 1) {
      *next++ = ObjectId{base + static_cast<std::uint32_t>(std::countr_zero(word))};
    }
  }
  ids.resize(count);
}

}  // namespace sightline
