#include "main_view/app/drawable_scene.hpp"

#include <utility>

#include <glm/gtc/matrix_transform.hpp>

namespace sightline {

DrawableScene::DrawableScene(Scene scene)
    : scene_(std::move(scene)),
      gpu_(scene_, true),
      renderer_(scene_, gpu_),
      hierarchy_(scene_.object_bounds) {
  all_ids_.reserve(scene_.object_count());
  for (std::uint32_t i = 0; i < scene_.object_count(); ++i) all_ids_.push_back(ObjectId{i});
}

std::vector<ObjectId> DrawableScene::ids_in_frustum(const Eye& eye) const {
  // The hierarchy's boxes lie in the scene frame.
  const glm::dmat4 world_from_scene = glm::translate(glm::dmat4(1.0), scene_.world_origin_m);
  std::vector<ObjectId> ids;
  hierarchy_.collect_in_frustum(frustum_of(eye.clip_from_world() * world_from_scene), ids);
  return ids;
}

}  // namespace sightline
