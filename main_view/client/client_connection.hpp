#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "main_view/client/client_options.hpp"
#include "main_view/client/culling_session.hpp"
#include "main_view/client/scene_upload.hpp"

namespace sightline {

/// A client's way to its daemon: says Hello, gives the daemon the scene where it lacks it, says Hello again;
/// and the same anew whenever the daemon is lost.
class ClientConnection {
 public:
  /// `scene`: shared with whoever else uploads it; null for one the daemon must have.
  ClientConnection(const ClientOptions& options, const SceneDigest& digest, std::uint32_t object_count,
                   std::shared_ptr<const PackedScene> scene);

  /// Moves everything that can be moved at once. `now_s`: of a clock that runs in real time.
  std::vector<Answer> poll(double now_s);
  /// Blocks until something has come or `timeout_s` passed; the next poll files it.
  void wait(double timeout_s);

  [[nodiscard]] ClientState state() const noexcept { return state_; }
  [[nodiscard]] const std::string& error_text() const noexcept { return error_text_; }
  [[nodiscard]] UploadProgress upload_progress() const noexcept;
  [[nodiscard]] CullingSession& session() noexcept { return session_; }
  [[nodiscard]] const CullingSession& session() const noexcept { return session_; }
  [[nodiscard]] std::uint64_t bytes_sent() const noexcept;
  [[nodiscard]] std::uint64_t bytes_received() const noexcept;

 private:
  void step_refused(double now_s);
  void end_upload() noexcept;

  ClientOptions options_;
  std::shared_ptr<const PackedScene> scene_;
  CullingSession session_;
  std::unique_ptr<SceneUpload> upload_;
  UploadProgress progress_;
  std::uint64_t upload_bytes_sent_ = 0, upload_bytes_received_ = 0;  ///< of uploads that are over
  ClientState state_ = ClientState::connecting;
  std::string error_text_;
  bool given_up_ = false;
  int fruitless_uploads_ = 0;  ///< in a row, after which the daemon still did not have the scene
};

}  // namespace sightline
