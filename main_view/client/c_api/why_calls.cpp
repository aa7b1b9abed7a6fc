// sl_ask_why, sl_take_why, sl_wait_why.

#include "main_view/client/c_api/client_handle.hpp"
#include "main_view/client/c_api/structures.hpp"
#include "main_view/client/c_api/timeout.hpp"

using namespace sightline::c_api;

extern "C" {

sl_status sl_ask_why(sl_client client, uint32_t view, uint32_t object, uint64_t* question) {
  return with_client(client, [&](ClientHandle& handle) {
    if (question == nullptr) fail(SL_ERROR_ARGUMENT, "question: null");
    *question = handle.questions.ask(view, object);
    return SL_OK;
  });
}

sl_status sl_take_why(sl_client client, uint64_t question, sl_why* answer) {
  return with_client(client, [&](ClientHandle& handle) {
    require_writable(answer, "sl_why");  // before the answer is taken: it is given once
    sl_why given{};
    const sl_status status = handle.questions.take(question, given);
    if (status == SL_OK) write_structure(answer, given, "sl_why");
    return status;
  });
}

sl_status sl_wait_why(sl_client client, uint32_t view, uint32_t object, double timeout_s, sl_why* answer) {
  return with_client(client, [&](ClientHandle& handle) {
    require_writable(answer, "sl_why");
    sl_why given{};
    const sl_status status = handle.questions.wait(view, object, checked_timeout_s(timeout_s), given);
    write_structure(answer, given, "sl_why");
    return status;
  });
}

}  // extern "C"
