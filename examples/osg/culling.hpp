#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <osg/Camera>
#include <osg/Matrixd>
#include <osg/Referenced>
#include <osg/Timer>
#include <osg/ref_ptr>
#include <osgUtil/CullVisitor>
#include <string>
#include <vector>

#include <sightline.h>

#include "examples/osg/cull_callbacks.hpp"
#include "examples/osg/graph_description.hpp"
#include "examples/osg/graph_watch.hpp"
#include "examples/osg/sightline_osg.hpp"

namespace sightline::osg_culling {

/// What one traversal of a camera draws, and by which projection.
struct FrameOfView {
  osg::Matrixd projection;
  DrawnBits drawn;  ///< null: everything
};

/// The working part of Culler: describes, watches, asks, and answers the callbacks in the graph.
class Culling : public osg::Referenced {
 public:
  Culling(osg::Node* scene_root, Options options);

  // Between frames.
  void add_camera(osg::Camera* camera, ViewKind kind);
  void set_enabled(bool enabled) { enabled_ = enabled; }
  /// Takes the callbacks off the graph and ends the session; the next frame begins anew, unless `for_good`.
  void take_down(bool for_good);
  bool wait_until_open(double timeout_s);
  [[nodiscard]] Statistics statistics() const;

  /// Called by a camera's callback as its traversal begins. The first one of a frame begins the frame for all
  /// views.
  [[nodiscard]] FrameOfView frame_of(std::size_t view, osgUtil::CullVisitor& visitor);

  // For the callbacks in the graph, while a frame is culled. [any thread]
  [[nodiscard]] const osg::Node* scene_root() const { return scene_root_.get(); }
  [[nodiscard]] const DescribedObject& object(std::uint32_t id) const { return description_.objects[id]; }
  [[nodiscard]] bool is_drawn(std::uint32_t id, const std::vector<std::uint64_t>& drawn) const;
  [[nodiscard]] bool any_drawn(IdRange objects, const std::vector<std::uint64_t>& drawn) const;
  [[nodiscard]] bool has_grown() const { return has_grown_; }

 protected:
  ~Culling() override;

 private:
  struct View {
    osg::ref_ptr<osg::Camera> camera;
    ViewKind kind = ViewKind::image;
    osg::ref_ptr<CameraCallback> callback;
    bool asked = false;        ///< in this frame, with the next two
    osg::Matrixd view_matrix;  ///< the camera's own
    osg::Matrixd projection;   ///< the camera's own, before planes are settled
    DrawnBits drawn;
  };

  void begin_frame(const osgUtil::CullVisitor& visitor);
  void describe(const osg::NodePath& above_root, osg::Node::NodeMask traversal_mask);
  void hang_callbacks();
  void follow_changes();
  void keep_out(IdRange objects, int change);
  [[nodiscard]] bool ask();
  [[nodiscard]] std::optional<sl_view> view_for(View& view) const;
  [[nodiscard]] DrawnBits drawn_in(std::uint32_t view) const;
  void warn(const std::string& what);

  mutable std::mutex mutex_;
  osg::ref_ptr<osg::Node> scene_root_;
  const Options options_;
  bool enabled_ = true;
  bool ended_ = false;
  bool tried_ = false;  ///< to describe the graph: once, until refresh
  sl_client client_ = nullptr;
  std::vector<View> views_;
  GraphDescription description_;
  GraphWatch watch_;
  osg::Node::NodeMask traversal_mask_ = ~0U;
  bool has_grown_ = false;
  /// For each object, for how many reasons the daemon takes it to be away: we draw it ourselves then.
  std::vector<std::uint32_t> kept_out_;
  std::optional<unsigned> frame_number_;
  osg::Timer clock_;
  std::string last_warning_;
  std::uint64_t visible_objects_ = 0;
  bool answered_ = false;
};

}  // namespace sightline::osg_culling
