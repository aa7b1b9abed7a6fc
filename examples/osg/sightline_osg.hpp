#pragma once

#include <cstdint>
#include <osg/Camera>
#include <osg/Node>
#include <osg/Referenced>
#include <osg/ref_ptr>
#include <string>

namespace sightline::osg_culling {

class Culling;

struct Options {
  std::string endpoint = "tcp://127.0.0.1:5571";  ///< of the daemon, control_view
  std::string client_name = "OpenSceneGraph";     ///< in the daemon's log

  /// Says that no osg::Program moves a vertex or discards a fragment. Without it, what a Program draws is
  /// always drawn and hides nothing, since nobody but the GPU knows where it ends up.
  bool programs_keep_shape = false;

  /// How long a frame waits for the answer to its own view, seconds; for programs that have time (offline
  /// rendering, tests). 0: no frame ever waits, and is drawn from what earlier requests predicted for it.
  double wait_for_answer_s = 0.0;

  /// Pixels of the daemon's image for each of the camera's, each way (and one more where that were the same
  /// size). 0: a size of the daemon's own, which is smaller and may miss a pixel of what shows through a
  /// slit. 1 is for pictures that are to be exact and wait for their answers. At most 3840 * 2160 pixels.
  double control_scale = 0.0;
};

enum class ViewKind {
  image,  ///< what a person sees; a mirror; a cube map's side
  shadow  ///< a light's depth map
};

struct Statistics {
  std::uint64_t objects = 0;          ///< drawables (each place of a shared one counts) that the daemon knows
  std::uint64_t triangles = 0;        ///< of these, in all places
  std::uint64_t unknown_nodes = 0;    ///< roots of what the adapter leaves alone: always drawn
  std::uint64_t visible_objects = 0;  ///< of the newest frame's first camera
  bool answered = false;              ///< that frame had an answer; else everything was drawn
  bool open = false;                  ///< the daemon has the scene and answers
  std::string state;                  ///< one line for a person: what is refused or awaited; may be empty
};

/// Culls what other objects hide from the images of cameras, by asking control_view. Two lines in a viewer:
///
///     sightline::osg_culling::Culler culler(model, "tcp://127.0.0.1:5571");
///     culler.cull(viewer.getCamera());
///
/// With the first frame it walks the graph below `scene_root`, describes each osg::Geometry that it
/// understands as an object, uploads that to the daemon (in the background, once; what the daemon has already
/// is not sent), and leaves out of each following frame what is certainly hidden. Until the daemon answers,
/// or whenever it does not, everything is drawn: it may cost time and never the picture.
///
/// Left alone, hence always drawn, and hiding nothing: nodes and drawables of other classes (particles, text,
/// billboards, paged levels of detail), points and lines, whatever has a cull or draw callback of its own,
/// instanced or stencilled drawing, polygon offset, clip planes, and Programs (see Options). Transforms that
/// move are followed; a Geometry, a node mask or a list of children that changes makes what is below it
/// always drawn until `refresh`, and so does a node's new StateSet. A StateSet edited in place is not
/// noticed: call `refresh`.
///
/// Near and far planes of a culled camera are set here, in place of OpenSceneGraph's own computation (which
/// knows them only when culling is over): around everything below the camera, with its near-far ratio.
/// Without a computation (DO_NOT_COMPUTE_NEAR_FAR) the camera's own projection stays as it is. Small-feature
/// culling is off for a culled camera: what it leaves out still hides things.
///
/// Threads: construct, cull, refresh and destroy between frames; frames may be culled by any threads of the
/// viewer. No function throws because of the daemon; std::bad_alloc alone passes.
class Culler {
 public:
  Culler(osg::Node* scene_root, Options options);
  Culler(osg::Node* scene_root, const std::string& endpoint);
  /// Takes its callbacks out of the graph and ends the session.
  ~Culler();
  Culler(const Culler&) = delete;
  Culler& operator=(const Culler&) = delete;

  /// Culls this camera's image from the next frame on. Up to 16 cameras (slaves, mirrors, a light's), each
  /// with the scene root below it. Cameras of other cull masks than the first draw everything.
  void cull(osg::Camera* camera, ViewKind kind = ViewKind::image);

  /// Walks the graph again before the next frame: after changes that are not followed. Everything is drawn
  /// until the daemon has the new scene.
  void refresh();

  /// Without culling everything is drawn, with the same near and far planes, and nothing is asked: for
  /// comparisons.
  void set_enabled(bool enabled);

  /// Waits until the daemon has the scene, at most `timeout_s`. Only a loading screen or a test needs it, and
  /// only after the first frame. Whether it has.
  bool wait_until_open(double timeout_s);

  [[nodiscard]] Statistics statistics() const;

 private:
  osg::ref_ptr<Culling> culling_;
};

}  // namespace sightline::osg_culling
