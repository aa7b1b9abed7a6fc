#include "examples/osg/camera_path.hpp"

#include <array>
#include <fstream>
#include <osg/Quat>
#include <sstream>
#include <stdexcept>
#include <string>

namespace sightline::osg_example {

std::vector<PathSample> read_camera_path(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line)) throw std::runtime_error(file.string() + ": cannot be read");
  std::vector<PathSample> path;
  for (int number = 2; std::getline(stream, line); ++number) {
    std::istringstream fields(line);
    std::array<double, 8> values{};
    char comma = ',';
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (i > 0) fields >> comma;
      fields >> values[i];
    }
    if (!fields || comma != ',') {
      throw std::runtime_error(file.string() + ": line " + std::to_string(number) +
                               " is not t,px,py,pz,qw,qx,qy,qz");
    }
    const auto [t, px, py, pz, qw, qx, qy, qz] = values;
    osg::Quat rotation(qx, qy, qz, qw);
    rotation /= rotation.length();
    path.push_back({t, osg::Matrixd::translate(-px, -py, -pz) * osg::Matrixd::rotate(rotation.inverse())});
  }
  if (path.empty()) throw std::runtime_error(file.string() + ": has no sample");
  return path;
}

}  // namespace sightline::osg_example
