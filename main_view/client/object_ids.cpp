#include "main_view/client/object_ids.hpp"

namespace sightline {

ObjectIds::ObjectIds(std::uint32_t first, std::uint32_t count) : fresh_(first), fresh_end_(first + count) {}

std::optional<ObjectId> ObjectIds::take() {
  if (fresh_ < fresh_end_) return ObjectId{fresh_++};
  if (free_.empty()) return {};
  const ObjectId id = free_.back();
  free_.pop_back();
  return id;
}

void ObjectIds::retire(ObjectId id, const RequestNumbers& next) {
  quarantine_.push_back({id, next});
}

void ObjectIds::release(const RequestNumbers& oldest) {
  // Numbers only go up: who left first may come back first.
  while (!quarantine_.empty()) {
    const Retired& retired = quarantine_.front();
    for (std::size_t view = 0; view < oldest.size(); ++view) {
      if (oldest[view] < retired.next[view]) return;
    }
    free_.push_back(retired.id);
    quarantine_.pop_front();
  }
}

}  // namespace sightline
