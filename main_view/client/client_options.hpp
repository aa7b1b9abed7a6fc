#pragma once

#include <cstdint>
#include <string>

#include "main_view/client/culling_options.hpp"
#include "protocol/endpoint_link.hpp"

namespace sightline {

struct ClientOptions {
  std::string endpoint;  ///< tcp:// or ipc://
  std::string client_name = "sightline client";
  CullingOptions culling;
  LinkOptions link;
  double reconnect_interval_s = 0.25;
  double silence_limit_s = 1.0;
};

/// How far a client is with its daemon. Frames may be begun in every state; until `ready` they list all
/// that is in the frustum.
enum class ClientState : std::uint8_t {
  connecting,  ///< nobody has answered yet, or the daemon is full
  uploading,   ///< the daemon lacks the scene and is being given it
  building,    ///< the daemon has all of it and prepares it
  ready,       ///< the session is open
  refused      ///< and stays so: error_text says why
};
[[nodiscard]] const char* to_string(ClientState state) noexcept;

}  // namespace sightline
