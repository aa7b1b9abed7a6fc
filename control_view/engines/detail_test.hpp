#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>

#include "common/gl/gpu_scene.hpp"
#include "common/scene/scene.hpp"
#include "control_view/engines/depth_hierarchy.hpp"
#include "control_view/engines/mesh_parts.hpp"
#include "control_view/engines/screen_box.hpp"

namespace sightline {

/// The closest look at an object short of drawing it: the boxes around its mesh's parts, where the object
/// stands now, each halved as far as that says more.
class DetailTest {
 public:
  explicit DetailTest(const Scene& scene);

  void move(std::span<const ObjectId> ids, std::span<const glm::dmat4> scene_from_object);

  /// Whether anything of the object's layer may show. Conservative; false when it has no such layer.
  [[nodiscard]] bool may_show(const BoxProjector& projector, const DepthHierarchy& depth, ObjectId id,
                              gl::Layer layer) const noexcept;

 private:
  MeshParts parts_;
  std::vector<glm::mat4> placements_;
  std::vector<std::uint32_t> mesh_of_object_;
};

}  // namespace sightline
