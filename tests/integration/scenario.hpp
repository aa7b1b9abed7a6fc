#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/camera_path.hpp"
#include "common/scene/scene.hpp"
#include "tests/common/test_scenes.hpp"
#include "tests/integration/process.hpp"

namespace sightline::testing {

/// A scene file and a camera path in a folder of the test's own.
class Scenario {
 public:
  Scenario(const Scene& scene, const CameraPath& path);

  [[nodiscard]] std::string scene_file() const { return (folder_ / "scene.glb").string(); }
  [[nodiscard]] std::string path_file() const { return (folder_ / "path.csv").string(); }
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_ / name).string(); }

  /// Runs `main_view audit` over it, with a daemon of its own unless `options` name one. Fails the test and
  /// returns null when it does not end with a report.
  [[nodiscard]] nlohmann::json audit(std::vector<std::string> options,
                                     const std::string& report = "report.json") const;

 private:
  TemporaryFolder folder_;
};

/// A small city walk: 400 objects, most of them hidden.
[[nodiscard]] Scenario small_city();

/// Poses every 1/60 s at `positions`, looking down -Z turned by `yaw_rad`.
[[nodiscard]] CameraPath path_through(const std::vector<glm::dvec3>& positions_m,
                                      const std::vector<double>& yaw_rad);

}  // namespace sightline::testing
