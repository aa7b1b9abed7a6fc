#include "main_view/client/seen_in_view.hpp"

#include <vector>

namespace sightline {

VisibleSet seen_in_view(const FiledSet& filed, std::span<const Eye> eyes) {
  std::vector<ObjectId> in_view;
  SeenSet(filed.set).visit_in_view(
      filed.request.eyes, eyes, [](ObjectId) { return false; }, [&](ObjectId id) { in_view.push_back(id); });
  return VisibleSet(in_view);
}

}  // namespace sightline
