#pragma once

#include <filesystem>
#include <osg/Matrixd>
#include <vector>

namespace sightline::osg_example {

/// When a camera was where: OpenSceneGraph's view matrix, world to camera.
struct PathSample {
  double time_s = 0.0;
  osg::Matrixd view;
};

/// Reads a CSV of `t,px,py,pz,qw,qx,qy,qz`: seconds, metres, camera to world, the camera looks down its -Z.
/// Throws std::runtime_error naming the file and the line.
[[nodiscard]] std::vector<PathSample> read_camera_path(const std::filesystem::path& file);

}  // namespace sightline::osg_example
