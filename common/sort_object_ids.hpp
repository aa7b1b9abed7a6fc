#pragma once

#include <cstdint>
#include <vector>

#include "common/object_id.hpp"

namespace sightline {

/// Sorts distinct ids below `object_count` in ascending order.
///
/// Cost follows the number of ids, not n log n: past a few hundred they are set in a bitmap, which is then
/// swept. The bitmap lives behind the ids in `ids` itself, so that a vector that is used again allocates
/// nothing.
void sort_object_ids(std::vector<ObjectId>& ids, std::uint32_t object_count);

}  // namespace sightline
