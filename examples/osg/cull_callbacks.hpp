#pragma once

#include <cstdint>
#include <memory>
#include <osg/Drawable>
#include <osg/NodeCallback>
#include <osg/NodeVisitor>
#include <osg/ref_ptr>
#include <vector>

#include "examples/osg/graph_description.hpp"

namespace sightline::osg_culling {

class Culling;  // counts its owners: a clone of a node may keep a callback for longer than a Culler lives

/// Ids of what a frame draws of a view: object i is bit i % 64 of word i / 64. Null: everything.
using DrawnBits = std::shared_ptr<const std::vector<std::uint64_t>>;

/// On a camera: begins the frame, settles near and far planes, and lets the callbacks below know what is
/// drawn while the camera's children are traversed.
class CameraCallback : public osg::NodeCallback {
 public:
  CameraCallback(Culling& culling, std::size_t view);
  void operator()(osg::Node* node, osg::NodeVisitor* visitor) override;

 protected:
  ~CameraCallback() override;

 private:
  osg::ref_ptr<Culling> culling_;
  std::size_t view_;
};

/// On a drawable, in all its places: leaves it out where it is hidden.
class DrawableCallback : public osg::DrawableCullCallback {
 public:
  using osg::DrawableCullCallback::cull;
  /// `ids` are those of the drawable's places.
  DrawableCallback(const Culling& culling, std::vector<std::uint32_t> ids);
  bool cull(osg::NodeVisitor* visitor, osg::Drawable* drawable, osg::RenderInfo* info) const override;

 protected:
  ~DrawableCallback() override;

 private:
  osg::ref_ptr<const Culling> culling_;
  std::vector<std::uint32_t> ids_;  ///< in the order of their paths
};

/// On a group of which all objects are known and that has one place: leaves it out when all are hidden.
class GroupCallback : public osg::NodeCallback {
 public:
  /// `path` leads from the scene root to the group.
  GroupCallback(const Culling& culling, osg::NodePath path, IdRange objects);
  void operator()(osg::Node* node, osg::NodeVisitor* visitor) override;

 protected:
  ~GroupCallback() override;

 private:
  osg::ref_ptr<const Culling> culling_;
  osg::NodePath path_;
  IdRange objects_;
};

}  // namespace sightline::osg_culling
