#include <algorithm>

#include "main_view/client/culling_core.hpp"

namespace sightline {

bool FrameDecision::may_be_untested(const Aabb& world_bounds) const {
  if (field_covered) return false;
  // Hidden for an eye when one of the sets looked at all of the object that this eye can see, and saw
  // nothing.
  for (std::size_t eye = 0; eye < eye_count; ++eye) {
    const bool was_tested = std::any_of(fields.begin(), fields.end(), [&](const TestedField& field) {
      return field.eye == eye && std::none_of(field.cuts.begin(), field.cuts.end(),
                                              [&](const CutOff& cut) { return cut.may_hold(world_bounds); });
    });
    if (!was_tested) return true;
  }
  return false;
}

}  // namespace sightline
