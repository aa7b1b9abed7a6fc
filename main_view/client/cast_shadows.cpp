#include "main_view/client/cast_shadows.hpp"

#include <algorithm>

#include <glm/geometric.hpp>

#include "main_view/client/occluder_shadow.hpp"

namespace sightline {

void cast_shadows(const Told& told, const ViewRequest& request, std::vector<ShadowToBe>& shadows) {
  for (const Eye& eye : request.eyes) {
    const bool sharable = OccluderShadow::depends_on_place_alone(eye);
    const auto shared = std::find_if(shadows.begin(), shadows.end(), [&](const ShadowToBe& shadow) {
      return sharable && shadow.told == &told && OccluderShadow::depends_on_place_alone(*shadow.eye) &&
             glm::length(position_of(eye) - position_of(*shadow.eye)) <= k_shared_shadow_m;
    });
    if (shared == shadows.end()) {
      shadows.push_back({&told, &eye, request.position_error_m});
    } else {
      const double apart_m = glm::length(position_of(eye) - position_of(*shared->eye));
      shared->slack_m = std::max(shared->slack_m, apart_m + request.position_error_m);
    }
  }
}

}  // namespace sightline
