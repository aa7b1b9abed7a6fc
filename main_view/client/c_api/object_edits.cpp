#include "main_view/client/c_api/object_edits.hpp"

#include <algorithm>
#include <span>
#include <string>

#include "main_view/client/c_api/failure.hpp"
#include "main_view/client/c_api/placement.hpp"
#include "main_view/client/c_api/scene_handle.hpp"
#include "main_view/client/c_api/structures.hpp"

namespace sightline::c_api {
namespace {

/// The ids, each of an object of the scene. `values` is what goes with them: null is refused unless there are
/// none.
std::vector<ObjectId> checked_ids(const CullingClient& client, const std::uint32_t* ids, std::size_t count,
                                  const void* values) {
  if (count == 0) return {};
  if (ids == nullptr || values == nullptr) fail(SL_ERROR_ARGUMENT, "objects: a null array");
  const std::uint32_t object_count = client.object_count();
  if (count > object_count) {
    fail(SL_ERROR_RANGE, "objects: " + std::to_string(count) + " of " + std::to_string(object_count));
  }
  std::vector<ObjectId> checked(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (ids[i] >= object_count) {
      fail(SL_ERROR_RANGE, "object " + std::to_string(ids[i]) + " of " + std::to_string(object_count));
    }
    checked[i] = ObjectId{ids[i]};
  }
  return checked;
}

std::vector<Aabb> checked_boxes(const sl_box* boxes, std::size_t count) {
  std::vector<Aabb> checked(count);
  for (std::size_t i = 0; i < count; ++i) checked[i] = box_of(boxes[i]);
  return checked;
}

}  // namespace

void move_objects(CullingClient& client, bool row_major, const std::uint32_t* ids, const double* matrices,
                  std::size_t count) {
  const std::vector<ObjectId> checked = checked_ids(client, ids, count, matrices);
  std::vector<glm::dmat4x3> placements(checked.size());
  for (std::size_t i = 0; i < checked.size(); ++i) {
    placements[i] = placement_of(std::span<const double, 16>(matrices + 16 * i, 16), row_major);
  }
  client.move_objects(checked, placements);
}

std::vector<SceneObject> scene_objects_of(const sl_boxed_object* objects, std::size_t count, bool row_major) {
  std::vector<SceneObject> described;
  if (count == 0) return described;
  if (objects == nullptr) fail(SL_ERROR_ARGUMENT, "objects: a null array");
  const auto* bytes = reinterpret_cast<const unsigned char*>(objects);
  for (std::size_t i = 0; i < count; ++i) {
    const auto* given = reinterpret_cast<const sl_boxed_object*>(bytes + i * objects->struct_size);
    const sl_boxed_object object = read_structure(given, "sl_boxed_object");
    if (given->struct_size != objects->struct_size) {
      fail(SL_ERROR_STRUCT_SIZE, "objects[" + std::to_string(i) + "].struct_size: not the first one's");
    }
    described.push_back({box_of(object.object_box),
                         placement_or_identity(object.world_from_object, row_major),
                         object_flags_of(object.flags), object.group});
  }
  return described;
}

void add_objects(CullingClient& client, std::vector<std::uint32_t>& flags_of_objects, bool row_major,
                 const sl_boxed_object* objects, std::size_t count, std::uint32_t* ids) {
  if (count == 0) return;
  if (ids == nullptr) fail(SL_ERROR_ARGUMENT, "ids: null");
  const auto refuse_as_full = [&] {
    fail(SL_ERROR_FULL, "no spare object is free for " + std::to_string(count) + ": " +
                            std::to_string(client.free_object_count()) + " are");
  };
  if (count > client.free_object_count()) refuse_as_full();
  std::vector<ObjectId> added;
  added.reserve(count);
  const std::vector<SceneObject> described = scene_objects_of(objects, count, row_major);
  for (const SceneObject& object : described) {
    // Before the first id is taken: a call that fails changes nothing.
    if (object.group != 0) fail(SL_ERROR_ARGUMENT, "objects: an added object cannot be of a group");
    if (has(object.flags, ObjectFlag::occluder_only))
      fail(SL_ERROR_ARGUMENT, "objects: an added object hides nothing, so it cannot be a proxy");
  }
  const auto take_back = [&] {
    for (const ObjectId id : added) client.remove_object(id);
  };
  try {
    for (const SceneObject& object : described) {
      const auto id = client.add_object(object);
      if (!id) refuse_as_full();
      added.push_back(*id);
    }
  } catch (...) {
    take_back();
    throw;
  }
  for (std::size_t i = 0; i < count; ++i) {
    ids[i] = index_of(added[i]);
    flags_of_objects[ids[i]] = described[i].flags;
  }
}

void remove_objects(CullingClient& client, const std::uint32_t* ids, std::size_t count) {
  std::vector<ObjectId> checked = checked_ids(client, ids, count, ids);
  std::sort(checked.begin(), checked.end());
  const auto twice = std::adjacent_find(checked.begin(), checked.end());
  if (twice != checked.end()) {
    fail(SL_ERROR_ARGUMENT, "object " + std::to_string(index_of(*twice)) + " is to be removed twice");
  }
  client.hide_objects(checked);  // refuses them all where one cannot be removed
  for (const ObjectId id : checked) client.remove_object(id);
}

void deform_objects(CullingClient& client, const std::uint32_t* ids, const sl_box* boxes, std::size_t count) {
  const std::vector<ObjectId> checked = checked_ids(client, ids, count, boxes);
  client.set_object_bounds(checked, checked_boxes(boxes, checked.size()));
}

void set_always_visible(CullingClient& client, std::vector<std::uint32_t>& flags_of_objects,
                        const std::uint32_t* ids, std::size_t count, bool always) {
  const std::vector<ObjectId> checked = checked_ids(client, ids, count, ids);
  constexpr auto k_always = static_cast<std::uint32_t>(ObjectFlag::always_visible);
  std::size_t done = 0;
  try {
    for (; done < checked.size(); ++done) {
      const std::uint32_t others = flags_of_objects[index_of(checked[done])] & ~k_always;
      client.set_object_flags(checked[done], always ? others | k_always : others);
    }
  } catch (...) {  // a spare id: those before it become again what they were
    while (done-- > 0) client.set_object_flags(checked[done], flags_of_objects[index_of(checked[done])]);
    throw;
  }
  for (const ObjectId id : checked) {
    std::uint32_t& flags = flags_of_objects[index_of(id)];
    flags = always ? flags | k_always : flags & ~k_always;
  }
}

void show_objects(CullingClient& client, const std::uint32_t* ids, std::size_t count, bool shown) {
  const std::vector<ObjectId> checked = checked_ids(client, ids, count, ids);
  if (shown) {
    client.show_objects(checked);
  } else {
    client.hide_objects(checked);
  }
}

}  // namespace sightline::c_api
