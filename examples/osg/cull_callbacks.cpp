#include "examples/osg/cull_callbacks.hpp"

#include <algorithm>
#include <osgUtil/CullVisitor>
#include <span>
#include <utility>

#include "examples/osg/culling.hpp"

namespace sightline::osg_culling {
namespace {

/// What the traversal of this thread draws. Traversals of one camera stay in one thread and nest.
struct Traversal {
  const Culling* culling = nullptr;
  const osg::RefMatrix* projection = nullptr;  ///< ours, while it is the one in force
  DrawnBits drawn;
};
thread_local const Traversal* current_traversal = nullptr;

/// The traversal in force for `visitor`, when it is one of `culling` that culls. Cameras and projections
/// further down in the graph see the scene by other matrices, for which nobody asked.
const Traversal* traversal_of(const Culling& culling, osg::NodeVisitor& visitor) {
  const Traversal* traversal = current_traversal;
  if (traversal == nullptr || traversal->culling != &culling || traversal->drawn == nullptr) return nullptr;
  osgUtil::CullVisitor* cull_visitor = visitor.asCullVisitor();
  if (cull_visitor == nullptr || cull_visitor->getProjectionMatrix() != traversal->projection) return nullptr;
  return traversal;
}

/// The nodes that lead from the scene root to where the visitor is.
std::span<osg::Node* const> way_from(const osg::Node* scene_root, const osg::NodePath& path) {
  const auto root = std::find(path.begin(), path.end(), scene_root);
  return {root, path.end()};
}

bool equal(std::span<osg::Node* const> way, const osg::NodePath& path) {
  return std::equal(way.begin(), way.end(), path.begin(), path.end());
}

/// Keeps the near and far planes that the request named: OpenSceneGraph moves those of every projection but
/// ours.
class KeepOurPlanes : public osg::CullSettings::ClampProjectionMatrixCallback {
 public:
  KeepOurPlanes(const osg::RefMatrix& ours, osgUtil::CullVisitor& visitor)
      : ours_(&ours), visitor_(&visitor), before_(visitor.getClampProjectionMatrixCallback()) {}

  bool clampProjectionMatrixImplementation(osg::Matrixf& matrix, double& near_m,
                                           double& far_m) const override {
    return before_ ? before_->clampProjectionMatrixImplementation(matrix, near_m, far_m)
                   : visitor_->clampProjectionMatrixImplementation(matrix, near_m, far_m);
  }
  bool clampProjectionMatrixImplementation(osg::Matrixd& matrix, double& near_m,
                                           double& far_m) const override {
    if (&matrix == static_cast<const osg::Matrixd*>(ours_)) return true;
    return before_ ? before_->clampProjectionMatrixImplementation(matrix, near_m, far_m)
                   : visitor_->clampProjectionMatrixImplementation(matrix, near_m, far_m);
  }
  [[nodiscard]] ClampProjectionMatrixCallback* before() const { return before_.get(); }

 private:
  const osg::RefMatrix* ours_;
  osgUtil::CullVisitor* visitor_;
  osg::ref_ptr<ClampProjectionMatrixCallback> before_;
};

}  // namespace

CameraCallback::CameraCallback(Culling& culling, std::size_t view) : culling_(&culling), view_(view) {}
CameraCallback::~CameraCallback() = default;

void CameraCallback::operator()(osg::Node* node, osg::NodeVisitor* visitor) {
  osgUtil::CullVisitor* cull_visitor = visitor->asCullVisitor();
  osg::Camera* camera = node->asCamera();
  if (cull_visitor == nullptr || camera == nullptr) {
    traverse(node, visitor);
    return;
  }
  const FrameOfView frame = culling_->frame_of(view_, *cull_visitor);
  const osg::ref_ptr<osg::RefMatrix> projection = new osg::RefMatrix(frame.projection);
  const Traversal traversal{culling_.get(), projection.get(), frame.drawn};
  const Traversal* const outer = std::exchange(current_traversal, &traversal);
  const osg::ref_ptr<KeepOurPlanes> planes = new KeepOurPlanes(*projection, *cull_visitor);
  const auto culling_mode = cull_visitor->getCullingMode();

  cull_visitor->setClampProjectionMatrixCallback(planes);
  // What is too small to be drawn would not hide what the daemon takes it to hide.
  cull_visitor->setCullingMode(culling_mode & ~osg::CullSettings::SMALL_FEATURE_CULLING);
  cull_visitor->pushProjectionMatrix(projection);
  traverse(node, visitor);
  cull_visitor->popProjectionMatrix();
  cull_visitor->setCullingMode(culling_mode);
  cull_visitor->setClampProjectionMatrixCallback(planes->before());
  current_traversal = outer;
}

DrawableCallback::DrawableCallback(const Culling& culling, std::vector<std::uint32_t> ids)
    : culling_(&culling), ids_(std::move(ids)) {
  std::sort(ids_.begin(), ids_.end(), [&](std::uint32_t a, std::uint32_t b) {
    const osg::NodePath& path_a = culling_->object(a).path;
    const osg::NodePath& path_b = culling_->object(b).path;
    return path_a != path_b ? path_a < path_b : a < b;
  });
}
DrawableCallback::~DrawableCallback() = default;

bool DrawableCallback::cull(osg::NodeVisitor* visitor, osg::Drawable*, osg::RenderInfo*) const {
  const Traversal* traversal = traversal_of(*culling_, *visitor);
  if (traversal == nullptr) return false;
  const auto way = way_from(culling_->scene_root(), visitor->getNodePath());
  const auto found =
      std::lower_bound(ids_.begin(), ids_.end(), way, [&](std::uint32_t id, std::span<osg::Node* const> to) {
        const osg::NodePath& path = culling_->object(id).path;
        return std::lexicographical_compare(path.begin(), path.end(), to.begin(), to.end());
      });
  // Another way than those described: it came later.
  if (found == ids_.end() || !equal(way, culling_->object(*found).path)) return false;
  return !culling_->is_drawn(*found, *traversal->drawn);
}

GroupCallback::GroupCallback(const Culling& culling, osg::NodePath path, IdRange objects)
    : culling_(&culling), path_(std::move(path)), objects_(objects) {}
GroupCallback::~GroupCallback() = default;

void GroupCallback::operator()(osg::Node* node, osg::NodeVisitor* visitor) {
  const Traversal* traversal = traversal_of(*culling_, *visitor);
  if (traversal != nullptr && !culling_->has_grown() &&
      equal(way_from(culling_->scene_root(), visitor->getNodePath()), path_) &&
      !culling_->any_drawn(objects_, *traversal->drawn)) {
    return;
  }
  traverse(node, visitor);
}

}  // namespace sightline::osg_culling
