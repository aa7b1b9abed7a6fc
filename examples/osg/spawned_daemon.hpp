#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

namespace sightline::osg_example {

/// A control_view without a scene, for as long as this object lives: it listens on a socket in a folder of
/// its own.
class SpawnedDaemon {
 public:
  /// Throws std::runtime_error when it cannot be started.
  SpawnedDaemon(const std::filesystem::path& executable, const std::vector<std::string>& arguments);
  ~SpawnedDaemon();
  SpawnedDaemon(const SpawnedDaemon&) = delete;
  SpawnedDaemon& operator=(const SpawnedDaemon&) = delete;

  [[nodiscard]] std::string endpoint() const { return "ipc://" + (folder_ / "daemon").string(); }

 private:
  std::filesystem::path folder_;
  pid_t process_ = -1;
};

}  // namespace sightline::osg_example
