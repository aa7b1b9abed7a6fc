#pragma once

#include <cstdint>
#include <vector>

#include "main_view/client/c_api/failure.hpp"
#include "main_view/client/c_api/frame_views.hpp"
#include "main_view/client/c_api/handle_table.hpp"
#include "main_view/client/c_api/open_questions.hpp"
#include "main_view/client/c_api/sightline.h"
#include "main_view/client/c_api/view_matrices.hpp"
#include "main_view/client/culling_client.hpp"

namespace sightline::c_api {

/// What a sl_client stands for: the C++ client and what C adds to it, which is places for views, a convention
/// of matrices, and checks.
struct ClientHandle {
  /// Throws Failure or InputError for options that are wrong, MachineError without a socket.
  explicit ClientHandle(const sl_options& options);
  ClientHandle(const ClientHandle&) = delete;
  ClientHandle& operator=(const ClientHandle&) = delete;

  [[nodiscard]] sl_state state() const;
  [[nodiscard]] sl_statistics statistics() const;

  MatrixConvention convention;
  SceneDigest digest{};
  std::vector<std::uint32_t> object_flags;  ///< ObjectFlag, by id: what the client was given
  CullingClient client;
  FrameViews views;
  OpenQuestions questions;
};

using ClientTable = HandleTable<ClientHandle, HandleKind::client>;
[[nodiscard]] ClientTable& client_table() noexcept;

/// Runs `call` on a client that nobody else is in: [one].
template <typename Call>
sl_status with_client(sl_client client, Call&& call) noexcept {
  const auto access = client_table().write(client);
  return guarded(client, [&]() -> sl_status {
    if (access.status() != SL_OK) return access.status();
    return call(*access.get());
  });
}

/// Runs `call` on a client that others may read as well: [shared].
template <typename Call>
sl_status with_shared_client(sl_client client, Call&& call) noexcept {
  const auto access = client_table().read(client);
  return guarded(client, [&]() -> sl_status {
    if (access.status() != SL_OK) return access.status();
    return call(static_cast<const ClientHandle&>(*access.get()));
  });
}

}  // namespace sightline::c_api
