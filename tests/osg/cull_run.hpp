#pragma once

#include <map>
#include <optional>
#include <osg/Camera>
#include <osg/FrameStamp>
#include <osg/Geode>
#include <osg/Geometry>
#include <osg/Group>
#include <osg/MatrixTransform>
#include <string>

#include "examples/osg/sightline_osg.hpp"
#include "examples/osg/spawned_daemon.hpp"

namespace sightline::osg_test {

/// Names of drawables, and in how many places each is drawn.
using Drawn = std::map<std::string, int>;

/// A rectangle across the Z axis, `half_m` to each side of (x, y, z); its front looks towards +Z.
[[nodiscard]] osg::ref_ptr<osg::Geometry> pane(const std::string& name, double x, double y, double z,
                                               double half_m);
[[nodiscard]] osg::ref_ptr<osg::Geode> geode_of(osg::Drawable* drawable);

/// A camera at (0, 0, 10) that looks down -Z with a field of 60 degrees, and its model. Frames are culled as
/// a viewer would, without OpenGL.
class CullRun {
 public:
  CullRun();

  osg::Group& model() { return *model_; }
  osg::Camera& camera() { return *camera_; }

  /// Adds a drawable in a Geode of its own, which it returns.
  osg::Geode& add(osg::Drawable* drawable);

  /// What the next frame draws.
  [[nodiscard]] Drawn frame();
  /// What another camera over the same model draws in the same frame.
  [[nodiscard]] Drawn same_frame(osg::Camera& camera);
  /// The projection that the last traversal drew with.
  [[nodiscard]] const osg::Matrixd& projection() const { return projection_; }

 private:
  Drawn cull(osg::Camera& camera);

  osg::ref_ptr<osg::Camera> camera_ = new osg::Camera;
  osg::ref_ptr<osg::Group> model_ = new osg::Group;
  osg::ref_ptr<osg::FrameStamp> stamp_ = new osg::FrameStamp;
  osg::Matrixd projection_;
};

/// The same with a daemon; each frame waits for its answer.
class CulledRun : public CullRun {
 public:
  explicit CulledRun(osg_culling::Options options = {});

  osg_culling::Culler& culler() { return *culler_; }
  /// Draws a frame, waits until the daemon has the scene, and draws the next.
  [[nodiscard]] Drawn first_frames();

 private:
  osg_example::SpawnedDaemon daemon_;
  std::optional<osg_culling::Culler> culler_;
};

}  // namespace sightline::osg_test
