// sl_connect to sl_wait_open, and sl_get_statistics.

#include <memory>
#include <string>
#include <utility>

#include "main_view/client/c_api/background_end.hpp"
#include "main_view/client/c_api/client_handle.hpp"
#include "main_view/client/c_api/structures.hpp"
#include "main_view/client/c_api/timeout.hpp"

using namespace sightline::c_api;

namespace {

void require_version(std::uint32_t program) {
  if ((program >> 16) == SL_VERSION_MAJOR && (program & 0xffff) <= SL_VERSION_MINOR) return;
  fail(SL_ERROR_VERSION, "sl_options.api_version: " + std::to_string(program >> 16) + "." +
                             std::to_string(program & 0xffff) + "; this libsightline serves " +
                             std::to_string(SL_VERSION_MAJOR) + ".0 to " + std::to_string(SL_VERSION_MAJOR) +
                             "." + std::to_string(SL_VERSION_MINOR) + " (set it to SL_API_VERSION)");
}

sl_status take_client(sl_client handle, std::unique_ptr<ClientHandle>& client) noexcept {
  sl_status status = SL_OK;
  client.reset(client_table().take(handle, status));
  return status;
}

}  // namespace

extern "C" {

sl_status sl_connect(const sl_options* options, sl_client* client) {
  return guarded(nullptr, [&]() -> sl_status {
    if (client == nullptr) fail(SL_ERROR_ARGUMENT, "client: null");
    *client = nullptr;
    const sl_options known = read_structure(options, "sl_options");
    require_version(known.api_version);
    auto made = std::make_unique<ClientHandle>(known);
    void* handle = client_table().insert(made.get());
    if (handle == nullptr) fail(SL_ERROR_FULL, "too many clients: close some");
    static_cast<void>(made.release());
    *client = static_cast<sl_client>(handle);
    return SL_OK;
  });
}

sl_status sl_close(sl_client client) {
  return guarded(client, [&] {
    std::unique_ptr<ClientHandle> taken;
    const sl_status status = take_client(client, taken);
    if (taken) end_in_background(std::move(taken));
    return status;
  });
}

sl_status sl_wait_close(sl_client client) {
  return guarded(client, [&] {
    std::unique_ptr<ClientHandle> taken;
    return take_client(client, taken);
  });
}

sl_status sl_poll(sl_client client) {
  return with_client(client, [](ClientHandle& handle) {
    handle.client.poll();
    return SL_OK;
  });
}

sl_status sl_get_state(sl_client client, sl_state* state) {
  return with_client(client, [&](ClientHandle& handle) {
    write_structure(state, handle.state(), "sl_state");
    return SL_OK;
  });
}

sl_status sl_wait_open(sl_client client, double timeout_s) {
  return with_client(client, [&](ClientHandle& handle) -> sl_status {
    switch (handle.client.wait_until_ready(checked_timeout_s(timeout_s))) {
      case sightline::ClientState::ready:
        return SL_OK;
      case sightline::ClientState::refused:
        fail(SL_ERROR_REFUSED, handle.client.error_text());
      default:
        return SL_TIMEOUT;
    }
  });
}

sl_status sl_get_statistics(sl_client client, sl_statistics* statistics) {
  return with_client(client, [&](ClientHandle& handle) {
    write_structure(statistics, handle.statistics(), "sl_statistics");
    return SL_OK;
  });
}

}  // extern "C"
