#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

#include "main_view/app/common_options.hpp"

namespace sightline {

/// A control_view process that lives as long as this object: started on a wildcard loopback port, ended by
/// its process id. It also dies with this process, should that be killed.
class SpawnedDaemon {
 public:
  /// Runs `control_view`, looked for beside this executable, with the settings of `options` that are given.
  /// Blocks until it listens. Throws InputError or MachineError with the daemon's own last line on standard
  /// error when it ends instead, after its exit code, and MachineError when it does not listen within
  /// `timeout_s`.
  SpawnedDaemon(const std::filesystem::path& scene, const ServiceOptions& options, double timeout_s = 120.0);
  ~SpawnedDaemon();
  SpawnedDaemon(const SpawnedDaemon&) = delete;
  SpawnedDaemon& operator=(const SpawnedDaemon&) = delete;

  [[nodiscard]] const std::string& endpoint() const noexcept { return endpoint_; }

 private:
  void stop() noexcept;

  pid_t process_id_ = -1;
  int output_ = -1;  ///< read end of the daemon's standard output
  std::string endpoint_;
};

/// The command line that SpawnedDaemon runs, executable first. For reports.
[[nodiscard]] std::vector<std::string> daemon_command(const std::filesystem::path& scene,
                                                      const ServiceOptions& options);

}  // namespace sightline
