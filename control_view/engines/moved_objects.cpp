#include "control_view/engines/moved_objects.hpp"

#include <algorithm>
#include <utility>

#include <glm/gtc/matrix_transform.hpp>

namespace sightline {

MovedObjects::MovedObjects(const Scene& scene) : world_origin_m_(scene.world_origin_m) {
  file_placements_.reserve(scene.objects.size());
  mesh_of_object_.reserve(scene.objects.size());
  for (const Object& object : scene.objects) {
    file_placements_.emplace_back(object.scene_from_object);
    mesh_of_object_.push_back(object.mesh);
  }
  mesh_bounds_.reserve(scene.meshes.size());
  for (const Mesh& mesh : scene.meshes) mesh_bounds_.push_back(mesh.bounds);
}

void MovedObjects::append(ObjectId id, const glm::dmat4& scene_from_object) {
  change_.ids.push_back(id);
  change_.scene_from_object.push_back(scene_from_object);
  change_.bounds.push_back(transformed(mesh_bounds_[mesh_of_object_[index_of(id)]], scene_from_object));
}

void MovedObjects::append_hidden(ObjectId id) {
  // The empty box keeps it out of every list, and a point has no pixels where a list is from before.
  glm::dmat4 point(0.0);
  point[3][3] = 1.0;
  change_.ids.push_back(id);
  change_.scene_from_object.push_back(point);
  change_.bounds.emplace_back();
}

const MovedObjects::Change& MovedObjects::turn_to(const SceneEdits& edits) {
  change_.ids.clear();
  change_.scene_from_object.clear();
  change_.bounds.clear();
  const bool untouched = edits.version == 0 && edited_.empty();
  if (untouched || (edits.owner == owner_ && edits.version == version_)) return change_;
  owner_ = edits.owner;
  version_ = edits.version;

  // All lists ascend: walk them together. What only the old one has goes back to where the file put it.
  std::vector<ObjectId> edited_now;
  edited_now.reserve(edits.moves.size() + edits.hidden.size());
  const glm::dmat4 scene_from_world = glm::translate(glm::dmat4(1.0), -world_origin_m_);
  auto old = edited_.begin();
  const auto put_back_before = [&](ObjectId limit, bool all) {
    for (; old != edited_.end() && (all || *old < limit); ++old) {
      append(*old, glm::dmat4(file_placements_[index_of(*old)]));
    }
    if (old != edited_.end() && !all && *old == limit) ++old;
  };
  auto move = edits.moves.begin();
  auto hidden = edits.hidden.begin();
  while (move != edits.moves.end() || hidden != edits.hidden.end()) {
    const bool is_hidden = hidden != edits.hidden.end() && (move == edits.moves.end() || *hidden <= move->id);
    const ObjectId id = is_hidden ? *hidden : move->id;
    put_back_before(id, false);
    if (is_hidden) {
      append_hidden(id);
      ++hidden;
    } else {
      append(id, scene_from_world * glm::dmat4(move->world_from_object));
    }
    if (move != edits.moves.end() && move->id == id) ++move;
    edited_now.push_back(id);
  }
  put_back_before(ObjectId{}, true);
  edited_ = std::move(edited_now);
  return change_;
}

}  // namespace sightline
