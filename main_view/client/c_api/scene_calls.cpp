// The sl_scene_... functions: check the handle, read the structure, hand over.

#include <cstring>
#include <memory>

#include "main_view/client/c_api/failure.hpp"
#include "main_view/client/c_api/scene_handle.hpp"
#include "main_view/client/c_api/structures.hpp"

namespace sightline::c_api {
namespace {

/// Runs `call` on a scene that nobody else is using.
template <typename Call>
sl_status with_scene(sl_scene scene, Call&& call) noexcept {
  const auto access = scene_table().write(scene);
  return guarded(scene, [&] {
    if (access.status() != SL_OK) return access.status();
    call(*access.get());
    return sl_status{SL_OK};
  });
}

template <typename Structure>
sl_status add(sl_scene scene, const Structure* given, const char* name, std::uint32_t* id,
              std::uint32_t (SceneHandle::*add_to)(const Structure&)) noexcept {
  return with_scene(scene, [&](SceneHandle& handle) {
    const std::uint32_t added = (handle.*add_to)(read_structure(given, name));
    if (id != nullptr) *id = added;
  });
}

}  // namespace
}  // namespace sightline::c_api

using namespace sightline::c_api;

extern "C" {

sl_status sl_scene_create(uint32_t matrix_layout, sl_scene* scene) {
  return guarded(nullptr, [&] {
    if (scene == nullptr) fail(SL_ERROR_ARGUMENT, "scene: null");
    *scene = nullptr;
    if (matrix_layout > SL_ROW_MAJOR)
      fail(SL_ERROR_ARGUMENT, "matrix_layout: SL_COLUMN_MAJOR or SL_ROW_MAJOR");
    auto made = std::make_unique<SceneHandle>(matrix_layout == SL_ROW_MAJOR);
    void* handle = scene_table().insert(made.get());
    if (handle == nullptr) fail(SL_ERROR_FULL, "too many scenes: destroy some");
    static_cast<void>(made.release());
    *scene = static_cast<sl_scene>(handle);
    return sl_status{SL_OK};
  });
}

sl_status sl_scene_destroy(sl_scene scene) {
  return guarded(scene, [&] {
    sl_status status = SL_OK;
    delete scene_table().take(scene, status);
    return status;
  });
}

sl_status sl_scene_add_material(sl_scene scene, const sl_material* material, uint32_t* id) {
  return add(scene, material, "sl_material", id, &SceneHandle::add_material);
}

sl_status sl_scene_add_mesh(sl_scene scene, const sl_mesh* mesh, uint32_t* id) {
  return add(scene, mesh, "sl_mesh", id, &SceneHandle::add_mesh);
}

sl_status sl_scene_add_object(sl_scene scene, const sl_object* object, uint32_t* id) {
  return add(scene, object, "sl_object", id, &SceneHandle::add_object);
}

sl_status sl_scene_set_spares(sl_scene scene, uint32_t count) {
  return with_scene(scene, [&](SceneHandle& handle) { handle.set_spares(count); });
}

sl_status sl_scene_digest(sl_scene scene, uint8_t digest[16], uint32_t* object_count) {
  return with_scene(scene, [&](SceneHandle& handle) {
    const auto packed = handle.packed();
    if (digest != nullptr) {
      static_assert(sizeof packed->objects.digest == 16);
      std::memcpy(digest, &packed->objects.digest, 16);
    }
    if (object_count != nullptr) *object_count = packed->objects.object_count();
  });
}

}  // extern "C"
