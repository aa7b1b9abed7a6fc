/* The header as a C99 program sees it: compiled with -std=c99 -pedantic-errors. */
#include "header_in_c99.h"

#include <sightline.h>

int c99_version_is_served(void) {
  return sl_version() >= SL_API_VERSION;
}

int c99_connects_without_a_daemon(void) {
  static const float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const uint32_t* ids = NULL;
  size_t count = 0;
  sl_scene scene = NULL;
  sl_client client = NULL;
  sl_mesh mesh = {.struct_size = sizeof mesh, .vertex_count = 3, .positions = positions};
  sl_object object = {.struct_size = sizeof object};
  sl_options options = {.struct_size = sizeof options, .api_version = SL_API_VERSION};
  sl_view view = {.struct_size = sizeof view, .width = 64, .height = 64};
  sl_frame frame = {.struct_size = sizeof frame, .view_count = 1};
  frame.views = &view;
  object.world_from_object[0] = object.world_from_object[5] = 1.0;
  object.world_from_object[10] = object.world_from_object[15] = 1.0;
  object.world_from_object[14] = -5.0;
  view.view[0] = view.view[5] = view.view[10] = view.view[15] = 1.0;
  view.projection[0] = view.projection[5] = 1.0;
  view.projection[10] = view.projection[11] = -1.0; /* infinite */
  view.projection[14] = -0.2;

  if (sl_scene_create(SL_COLUMN_MAJOR, &scene) != SL_OK) return 1;
  if (sl_scene_add_mesh(scene, &mesh, &object.mesh) != SL_OK) return 2;
  if (sl_scene_add_object(scene, &object, NULL) != SL_OK) return 3;
  options.scene = scene;
  options.endpoint = "ipc:///nonexistent/folder/of/nobody";
  if (sl_connect(&options, &client) != SL_OK) return 4;
  if (sl_scene_destroy(scene) != SL_OK) return 5;
  if (sl_begin_frame(client, &frame) != SL_OK) return 6;
  if (sl_visible_ids(client, 0, &ids, &count) != SL_OK) return 7;
  if (count != 1 || ids[0] != 0) return 8;
  if (sl_object_state(client, 0, 0) != SL_VISIBLE) return 9;
  return sl_close(client) == SL_OK ? 0 : 10;
}
