#pragma once

#include <memory>

#include "main_view/client/c_api/client_handle.hpp"

namespace sightline::c_api {

/// Ends a client in the background: its last frames may take a tenth of a second to leave. The process waits
/// for that at its end. Where no thread is to be had, ends it here.
void end_in_background(std::unique_ptr<ClientHandle> client) noexcept;

}  // namespace sightline::c_api
