#include "control_view/engines/detail_test.hpp"

#include <algorithm>

#include "control_view/engines/fine_test.hpp"

namespace sightline {

DetailTest::DetailTest(const Scene& scene) : parts_(scene) {
  placements_.reserve(scene.objects.size());
  mesh_of_object_.reserve(scene.objects.size());
  for (const Object& object : scene.objects) {
    placements_.emplace_back(object.scene_from_object);
    mesh_of_object_.push_back(object.mesh);
  }
}

void DetailTest::move(std::span<const ObjectId> ids, std::span<const glm::dmat4> scene_from_object) {
  for (std::size_t i = 0; i < ids.size(); ++i)
    placements_[index_of(ids[i])] = glm::mat4(scene_from_object[i]);
}

bool DetailTest::may_show(const BoxProjector& projector, const DepthHierarchy& depth, ObjectId id,
                          gl::Layer layer) const noexcept {
  const std::span<const Aabb> parts = parts_.of(mesh_of_object_[index_of(id)], layer);
  if (parts.empty()) return false;
  const BoxProjector placed = projector.placed(placements_[index_of(id)]);
  return std::any_of(parts.begin(), parts.end(),
                     [&](const Aabb& part) { return may_show_finely(placed, depth, part); });
}

}  // namespace sightline
