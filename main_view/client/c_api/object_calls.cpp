// sl_move_objects to sl_show_objects.

#include "main_view/client/c_api/client_handle.hpp"
#include "main_view/client/c_api/object_edits.hpp"

using namespace sightline::c_api;

extern "C" {

sl_status sl_move_objects(sl_client client, const uint32_t* ids, const double* world_from_object,
                          size_t count) {
  return with_client(client, [&](ClientHandle& handle) {
    move_objects(handle.client, handle.convention.row_major, ids, world_from_object, count);
    return SL_OK;
  });
}

sl_status sl_add_objects(sl_client client, const sl_boxed_object* objects, size_t count, uint32_t* ids) {
  return with_client(client, [&](ClientHandle& handle) {
    add_objects(handle.client, handle.object_flags, handle.convention.row_major, objects, count, ids);
    return SL_OK;
  });
}

sl_status sl_remove_objects(sl_client client, const uint32_t* ids, size_t count) {
  return with_client(client, [&](ClientHandle& handle) {
    remove_objects(handle.client, ids, count);
    return SL_OK;
  });
}

sl_status sl_replace_objects(sl_client client, const uint32_t* ids, const sl_box* object_boxes,
                             size_t count) {
  return with_client(client, [&](ClientHandle& handle) {
    deform_objects(handle.client, ids, object_boxes, count);
    return SL_OK;
  });
}

sl_status sl_deform_objects(sl_client client, const uint32_t* ids, const sl_box* object_boxes, size_t count) {
  return with_client(client, [&](ClientHandle& handle) {
    deform_objects(handle.client, ids, object_boxes, count);
    return SL_OK;
  });
}

sl_status sl_set_always_visible(sl_client client, const uint32_t* ids, size_t count, int always) {
  return with_client(client, [&](ClientHandle& handle) {
    set_always_visible(handle.client, handle.object_flags, ids, count, always != 0);
    return SL_OK;
  });
}

sl_status sl_show_objects(sl_client client, const uint32_t* ids, size_t count, int shown) {
  return with_client(client, [&](ClientHandle& handle) {
    show_objects(handle.client, ids, count, shown != 0);
    return SL_OK;
  });
}

}  // extern "C"
