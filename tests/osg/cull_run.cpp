#include "tests/osg/cull_run.hpp"

#include <osgUtil/CullVisitor>
#include <stdexcept>

namespace sightline::osg_test {
namespace {

constexpr int k_side = 256;  // pixels

void collect(const osgUtil::StateGraph& graph, Drawn& drawn, osg::Matrixd& projection) {
  for (const auto& leaf : graph._leaves) {
    ++drawn[leaf->getDrawable()->getName()];
    projection = *leaf->_projection;
  }
  for (const auto& [state, child] : graph._children) collect(*child, drawn, projection);
}

}  // namespace

osg::ref_ptr<osg::Geometry> pane(const std::string& name, double x, double y, double z, double half_m) {
  osg::ref_ptr<osg::Vec3dArray> corners = new osg::Vec3dArray;
  corners->push_back({x - half_m, y - half_m, z});
  corners->push_back({x + half_m, y - half_m, z});
  corners->push_back({x + half_m, y + half_m, z});
  corners->push_back({x - half_m, y + half_m, z});
  osg::ref_ptr<osg::Geometry> geometry = new osg::Geometry;
  geometry->setName(name);
  geometry->setVertexArray(corners);
  geometry->addPrimitiveSet(new osg::DrawArrays(GL_QUADS, 0, 4));
  return geometry;
}

osg::ref_ptr<osg::Geode> geode_of(osg::Drawable* drawable) {
  osg::ref_ptr<osg::Geode> geode = new osg::Geode;
  geode->addDrawable(drawable);
  return geode;
}

CullRun::CullRun() {
  camera_->setViewport(0, 0, k_side, k_side);
  camera_->setViewMatrixAsLookAt({0, 0, 10}, {0, 0, 0}, {0, 1, 0});
  camera_->setProjectionMatrixAsPerspective(60.0, 1.0, 1.0, 100.0);
  camera_->addChild(model_);
}

osg::Geode& CullRun::add(osg::Drawable* drawable) {
  const osg::ref_ptr<osg::Geode> geode = geode_of(drawable);
  model_->addChild(geode);
  return *geode;
}

Drawn CullRun::frame() {
  stamp_->setFrameNumber(stamp_->getFrameNumber() + 1);
  return cull(*camera_);
}

Drawn CullRun::same_frame(osg::Camera& camera) {
  return cull(camera);
}

Drawn CullRun::cull(osg::Camera& camera) {
  const osg::ref_ptr<osgUtil::CullVisitor> visitor = osgUtil::CullVisitor::create();
  const osg::ref_ptr<osgUtil::StateGraph> graph = new osgUtil::StateGraph;
  const osg::ref_ptr<osgUtil::RenderStage> stage = new osgUtil::RenderStage;
  visitor->setCullSettings(camera);
  visitor->setStateGraph(graph);
  visitor->setRenderStage(stage);
  visitor->setFrameStamp(stamp_);
  visitor->setTraversalNumber(stamp_->getFrameNumber());
  stage->setViewport(camera.getViewport());
  stage->setCamera(&camera);
  visitor->pushViewport(camera.getViewport());
  visitor->pushProjectionMatrix(new osg::RefMatrix(camera.getProjectionMatrix()));
  visitor->pushModelViewMatrix(new osg::RefMatrix(camera.getViewMatrix()), osg::Transform::ABSOLUTE_RF);
  if (camera.getCullCallback() != nullptr) {
    camera.getCullCallback()->run(&camera, visitor);
  } else {
    visitor->traverse(camera);
  }
  visitor->popModelViewMatrix();
  visitor->popProjectionMatrix();
  visitor->popViewport();
  Drawn drawn;
  collect(*graph, drawn, projection_);
  return drawn;
}

CulledRun::CulledRun(osg_culling::Options options)
    : daemon_(SIGHTLINE_CONTROL_VIEW, {"--size", "256x256", "--engine", "raster"}) {
  options.endpoint = daemon_.endpoint();
  options.wait_for_answer_s = 20.0;
  culler_.emplace(&model(), options);
  culler_->cull(&camera());
}

Drawn CulledRun::first_frames() {
  static_cast<void>(frame());
  if (!culler_->wait_until_open(20.0)) throw std::runtime_error("no daemon: " + culler_->statistics().state);
  return frame();
}

}  // namespace sightline::osg_test
