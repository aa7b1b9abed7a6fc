#pragma once

#include <cstdint>
#include <vector>

#include <glm/mat4x3.hpp>

#include "common/bounds.hpp"
#include "common/object_id.hpp"
#include "common/scene_digest.hpp"

namespace sightline {

/// What a client knows of an object of its scene.
struct SceneObject {
  Aabb object_bounds;  ///< object's own frame, metres; holds all that it draws. Empty: nothing
  glm::dmat4x3 world_from_object{1.0};  ///< as the scene has it; world frame, metres
  std::uint32_t flags = 0;              ///< of ObjectFlag (protocol/scene_data.hpp)
  std::uint32_t group = 0;  ///< objects of one group other than 0 are levels of detail of one thing
};

/// The object table of a scene that the daemon has, or is going to be given: object i is ObjectId i. The last
/// `spare_objects` ids have no geometry and wait for CullingClient::add_object; they are not in `objects`.
struct SceneObjects {
  SceneDigest digest{};
  std::vector<SceneObject> objects;
  std::uint32_t spare_objects = 0;

  [[nodiscard]] std::uint32_t object_count() const noexcept {
    return static_cast<std::uint32_t>(objects.size()) + spare_objects;
  }
};

}  // namespace sightline
