/* Culling for the town by control_view. Start the daemon, then this, with its endpoint:

     control_view --bind tcp://127.0.0.1:5571
     cull_scene tcp://127.0.0.1:5571 [FRAMES] */
#include <sightline.h>
#include <stdio.h>
#include <stdlib.h>

#include "town.h"

static int failed(const char* what) {
  return fprintf(stderr, "%s: %s\n", what, sl_last_error(NULL)), 1;
}

/* The daemon is told what can hide what: each house, by its triangles. */
static sl_status describe(sl_scene scene) {
  uint32_t mesh;
  sl_mesh house = {.struct_size = sizeof house, .vertex_count = HOUSE_VERTICES, .positions = house_positions};
  house.indices = house_indices;
  house.index_count = HOUSE_INDICES;
  sl_status status = sl_scene_add_mesh(scene, &house, &mesh);
  for (uint32_t i = 0; i < TOWN_HOUSES && status == SL_OK; ++i) {
    sl_object object = {.struct_size = sizeof object, .mesh = mesh};
    place_house(i, object.world_from_object);
    status = sl_scene_add_object(scene, &object, NULL); /* ids count up from 0, as the houses do */
  }
  return status;
}

int main(int argc, char** argv) {
  const int frames = argc > 2 ? atoi(argv[2]) : 600;
  sl_scene scene;
  if (sl_scene_create(SL_COLUMN_MAJOR, &scene) || describe(scene)) return failed("the scene");

  sl_client client;
  sl_options options = {.struct_size = sizeof options, .api_version = SL_API_VERSION, .scene = scene};
  options.endpoint = argc > 1 ? argv[1] : "tcp://127.0.0.1:5571";
  if (sl_connect(&options, &client)) return failed("connecting");
  sl_scene_destroy(scene);
  sl_state state = {.struct_size = sizeof state};
  if (sl_wait_open(client, 10.0) != SL_OK && sl_get_state(client, &state) == SL_OK)
    fprintf(stderr, "drawing all in view: %s\n", state.text[0] ? state.text : "no daemon yet");

  const double start_s = seconds_now();
  for (int i = 0; i < frames; ++i) {
    sl_view view = {.struct_size = sizeof view, .width = 1024, .height = 768};
    sl_frame frame = {.struct_size = sizeof frame, .view_count = 1, .views = &view, .time_s = seconds_now()};
    camera_at(frame.time_s - start_s, 1024.0 / 768.0, view.view, view.projection);
    const uint32_t* visible;
    size_t count;
    if (sl_begin_frame(client, &frame) || sl_visible_ids(client, 0, &visible, &count))
      return failed("a frame");
    for (size_t j = 0; j < count; ++j) draw_house(visible[j]);
    swap_buffers();
  }
  sl_statistics seen = {.struct_size = sizeof seen};
  sl_get_statistics(client, &seen);
  sl_wait_close(client);
  printf("%d frames, %lu answers, %.1f of %d houses drawn a frame\n", frames, (unsigned long)seen.answers,
         (double)houses_drawn() / (frames > 0 ? frames : 1), TOWN_HOUSES);
  return 0;
}
