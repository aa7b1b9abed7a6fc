#pragma once

#include <memory>
#include <string>

#include "common/scene/scene.hpp"
#include "main_view/app/common_options.hpp"
#include "main_view/app/spawned_daemon.hpp"
#include "main_view/client/culling_core.hpp"
#include "main_view/client/culling_session.hpp"

namespace sightline {

/// A session with the daemon that ServiceOptions ask for, and that daemon itself where --spawn starts it.
class ServiceConnection {
 public:
  /// Starts the daemon (see SpawnedDaemon: blocks until it has loaded its scene) or only names it. Does not
  /// wait for the session to open.
  ServiceConnection(const std::filesystem::path& scene_file, const Scene& scene,
                    const ServiceOptions& options);

  /// Blocks until the session is open and has the settings asked for. Throws InputError when the daemon
  /// refuses (with its reason) or has other settings, MachineError naming the endpoint when nobody answers.
  void require_open(double timeout_s = 10.0);

  [[nodiscard]] CullingSession& session() noexcept { return session_; }
  [[nodiscard]] const std::string& endpoint() const noexcept { return endpoint_; }

 private:
  ServiceOptions options_;
  std::unique_ptr<SpawnedDaemon> daemon_;
  std::string endpoint_;
  CullingSession session_;
};

/// The options of the client's deciding part that the command line can change.
[[nodiscard]] CullingOptions culling_options_of(const ServiceOptions& options);

/// One eye at the head, or two `eye_separation_m` apart.
[[nodiscard]] std::vector<RigEye> rig_of(const SceneOptions& scene, const ReplayOptions& replay);

}  // namespace sightline
