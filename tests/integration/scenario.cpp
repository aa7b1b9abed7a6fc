#include "tests/integration/scenario.hpp"

#include <algorithm>
#include <fstream>

#include <gtest/gtest.h>

#include "common/scene/generate_city.hpp"
#include "common/scene/write_glb.hpp"

namespace sightline::testing {

Scenario::Scenario(const Scene& scene, const CameraPath& path) {
  write_glb(scene_file(), scene);
  write_camera_path(path_file(), path);
}

nlohmann::json Scenario::audit(std::vector<std::string> options, const std::string& report) const {
  std::vector<std::string> command = {main_view_executable(),
                                      "audit",
                                      "--scene",
                                      scene_file(),
                                      "--path",
                                      path_file(),
                                      "--json",
                                      file(report)};
  if (std::find(options.begin(), options.end(), "--connect") == options.end())
    command.emplace_back("--spawn");
  command.insert(command.end(), options.begin(), options.end());
  const Finished finished = run(command);
  if (finished.exit_code != 0 && finished.exit_code != 1) {
    ADD_FAILURE() << "audit ended with " << finished.exit_code << ": " << finished.err;
    return nullptr;
  }
  std::ifstream in(file(report));
  return nlohmann::json::parse(in, nullptr, false);
}

Scenario small_city() {
  return {generate_city(400, 5), city_path(400, 5)};
}

CameraPath path_through(const std::vector<glm::dvec3>& positions_m, const std::vector<double>& yaw_rad) {
  CameraPath path;
  for (std::size_t i = 0; i < positions_m.size(); ++i) {
    path.samples.push_back(
        {double(i) / 60.0, {positions_m[i], glm::angleAxis(yaw_rad[i], glm::dvec3(0.0, 1.0, 0.0))}});
  }
  return path;
}

}  // namespace sightline::testing
