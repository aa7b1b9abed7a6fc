#include "examples/osg/load_model.hpp"

#include <osg/AnimationPath>
#include <osgDB/ReadFile>
#include <osgGA/AnimationPathManipulator>
#include <osgUtil/SmoothingVisitor>
#include <stdexcept>

#include "examples/osg/camera_path.hpp"
#include "examples/osg/glb_reader.hpp"

namespace sightline::osg_example {

osg::ref_ptr<osg::Node> load_model(const std::filesystem::path& file) {
  osg::ref_ptr<osg::Node> model;
  if (file.extension() == ".glb") {
    model = read_glb(file);
    osgUtil::SmoothingVisitor smoothing;
    smoothing.setCreaseAngle(0.5);  // radians: edges of buildings stay edges
    model->accept(smoothing);
  } else {
    model = osgDB::readRefNodeFile(file.string());
  }
  if (!model) throw std::runtime_error(file.string() + ": OpenSceneGraph cannot read it");
  return model;
}

osg::ref_ptr<osgGA::CameraManipulator> path_player(const std::filesystem::path& file) {
  osg::ref_ptr<osg::AnimationPath> path = new osg::AnimationPath;
  path->setLoopMode(osg::AnimationPath::LOOP);
  for (const PathSample& sample : read_camera_path(file)) {
    const osg::Matrixd world_from_camera = osg::Matrixd::inverse(sample.view);
    path->insert(sample.time_s, {world_from_camera.getTrans(), world_from_camera.getRotate()});
  }
  return new osgGA::AnimationPathManipulator(path);
}

}  // namespace sightline::osg_example
