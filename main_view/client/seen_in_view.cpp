#include "main_view/client/seen_in_view.hpp"

#include <vector>

namespace sightline {

VisibleSet seen_in_view(const FiledSet& filed, std::span<const Eye> eyes) {
  std::vector<ObjectId> in_view;
  const std::vector<SeenSet::View> views(eyes.begin(), eyes.end());
  SeenSet(filed.set).visit_in_view(
      filed.request.eyes, views, [](ObjectId) { return false; }, [&](ObjectId id) { in_view.push_back(id); });
  return VisibleSet(in_view);
}

}  // namespace sightline
