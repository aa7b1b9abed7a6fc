#pragma once

#include <vector>

#include "common/object_hierarchy.hpp"
#include "main_view/app/renderer.hpp"

namespace sightline {

/// A scene with all that drawing and culling it takes. A GL context must be current for its whole life.
class DrawableScene {
 public:
  explicit DrawableScene(Scene scene);
  DrawableScene(const DrawableScene&) = delete;
  DrawableScene& operator=(const DrawableScene&) = delete;

  /// Every object, ascending.
  [[nodiscard]] const std::vector<ObjectId>& all_ids() const noexcept { return all_ids_; }
  /// Objects that may intersect the view frustum, ascending. Conservative.
  [[nodiscard]] std::vector<ObjectId> ids_in_frustum(const Eye& eye) const;

  [[nodiscard]] const Scene& scene() const noexcept { return scene_; }
  [[nodiscard]] gl::GpuScene& gpu() noexcept { return gpu_; }
  [[nodiscard]] SceneRenderer& renderer() noexcept { return renderer_; }
  [[nodiscard]] const ObjectHierarchy& hierarchy() const noexcept { return hierarchy_; }

 private:
  Scene scene_;
  gl::GpuScene gpu_;
  SceneRenderer renderer_;
  ObjectHierarchy hierarchy_;
  std::vector<ObjectId> all_ids_;
};

}  // namespace sightline
