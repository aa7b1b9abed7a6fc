#include "main_view/client/seen_in_view.hpp"

#include <algorithm>
#include <vector>

#include <glm/geometric.hpp>

#include "common/direction_extent.hpp"

namespace sightline {

VisibleSet seen_in_view(const FiledSet& filed, std::span<const Eye> eyes) {
  const std::vector<ObjectId> ids = filed.set.to_ids();
  const std::span<const DirectionExtent> extents = filed.set.extents();
  if (extents.size() != ids.size()) return filed.set;

  struct View {
    DirectionField field;
    double offset_m;  ///< from the farthest of the eyes that the extents were seen by
  };
  std::vector<View> views;
  for (const Eye& eye : eyes) {
    double offset_m = 0.0;
    for (const Eye& requested : filed.request.eyes) {
      offset_m = std::max(offset_m, glm::length(position_of(eye) - position_of(requested)));
    }
    views.push_back({DirectionField(frustum_of(eye.clip_from_world())), offset_m});
  }
  std::vector<ObjectId> in_view;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const bool reached = std::any_of(views.begin(), views.end(), [&](const View& view) {
      return view.field.may_hold(extents[i], view.offset_m);
    });
    if (reached) in_view.push_back(ids[i]);
  }
  return VisibleSet(in_view);
}

}  // namespace sightline
