// sl_begin_frame to sl_get_view_info.

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "main_view/client/c_api/client_handle.hpp"
#include "main_view/client/c_api/structures.hpp"
#include "main_view/client/c_api/timeout.hpp"

using namespace sightline::c_api;

namespace {

void require(const void* first, const void* second) {
  if (first == nullptr || second == nullptr) fail(SL_ERROR_ARGUMENT, "where the answer goes: null");
}

}  // namespace

extern "C" {

sl_status sl_begin_frame(sl_client client, const sl_frame* frame) {
  return with_client(client, [&](ClientHandle& handle) {
    handle.views.begin(read_structure(frame, "sl_frame"));
    return SL_OK;
  });
}

sl_status sl_wait_frame(sl_client client, const sl_frame* frame, double timeout_s) {
  return with_client(client, [&](ClientHandle& handle) -> sl_status {
    const double checked_s = checked_timeout_s(timeout_s);
    return handle.views.wait(read_structure(frame, "sl_frame"), checked_s) ? SL_OK : SL_TIMEOUT;
  });
}

int32_t sl_object_state(sl_client client, uint32_t view, uint32_t object) {
  // Asked for each object of a frame: a failure costs no text.
  const auto access = client_table().read(client);
  return access.status() == SL_OK ? access.get()->views.object_state(view, object) : access.status();
}

sl_status sl_visible_ids(sl_client client, uint32_t view, const uint32_t** ids, size_t* count) {
  return with_shared_client(client, [&](const ClientHandle& handle) {
    require(ids, count);
    const auto visible = handle.views.at(view).visible();
    static_assert(sizeof(sightline::ObjectId) == sizeof(uint32_t));
    *ids = reinterpret_cast<const uint32_t*>(visible.data());
    *count = visible.size();
    return SL_OK;
  });
}

sl_status sl_visible_bits(sl_client client, uint32_t view, const uint64_t** words, size_t* word_count) {
  return with_shared_client(client, [&](const ClientHandle& handle) {
    require(words, word_count);
    const auto bits = handle.views.at(view).bits();
    *words = bits.data();
    *word_count = bits.size();
    return SL_OK;
  });
}

sl_status sl_copy_visible_ids(sl_client client, uint32_t view, uint32_t* ids, size_t capacity,
                              size_t* count) {
  return with_shared_client(client, [&](const ClientHandle& handle) {
    if (count == nullptr || (ids == nullptr && capacity > 0)) require(nullptr, nullptr);
    const auto visible = handle.views.at(view).visible();
    const std::size_t copied = std::min(capacity, visible.size());
    if (copied > 0) std::memcpy(ids, visible.data(), copied * sizeof *ids);
    *count = visible.size();
    return SL_OK;
  });
}

sl_status sl_get_view_info(sl_client client, uint32_t view, sl_view_info* info) {
  return with_shared_client(client, [&](const ClientHandle& handle) {
    write_structure(info, handle.views.info(view), "sl_view_info");
    return SL_OK;
  });
}

}  // extern "C"
