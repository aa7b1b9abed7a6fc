#pragma once

#include <cstdint>
#include <vector>

#include <glm/mat4x4.hpp>

#include "common/object_hierarchy.hpp"
#include "common/scene/scene.hpp"
#include "control_view/engine.hpp"

namespace sightline {

/// Keeps the placements of a scene's objects in step with a session's edits: which objects have to change
/// when the engine turns from one session's state to another's, and where to.
class MovedObjects {
 public:
  explicit MovedObjects(const Scene& scene);

  struct Change {
    std::vector<ObjectId> ids;  ///< ascending
    std::vector<glm::dmat4> scene_from_object;
    std::vector<Aabb> bounds;  ///< scene frame, conservative; empty for one that is hidden now
  };

  /// The objects to move so that exactly `edits` holds; empty when it already does. Valid until the next
  /// call.
  const Change& turn_to(const SceneEdits& edits);

 private:
  void append(ObjectId id, const glm::dmat4& scene_from_object);
  void append_hidden(ObjectId id);

  glm::dvec3 world_origin_m_;
  std::vector<glm::mat4> file_placements_;  ///< as the GPU has them
  std::vector<Aabb> mesh_bounds_;
  std::vector<std::uint32_t> mesh_of_object_;
  std::uint64_t owner_ = 0;
  std::uint64_t version_ = 0;
  std::vector<ObjectId> edited_;  ///< away from the file's placement or hidden, ascending
  Change change_;
};

}  // namespace sightline
