// The same, culled by a daemon: osg_viewer_culled MODEL [PATH.csv]

#include <exception>
#include <iostream>
#include <osgGA/TrackballManipulator>
#include <osgViewer/Viewer>
#include <osgViewer/ViewerEventHandlers>

#include "examples/osg/load_model.hpp"
#include "examples/osg/sightline_osg.hpp"

using namespace sightline::osg_example;

int main(int argc, char** argv) {
  try {
    if (argc < 2) throw std::runtime_error("usage: osg_viewer_culled MODEL [PATH.csv]");
    const osg::ref_ptr<osg::Node> model = load_model(argv[1]);
    osgViewer::Viewer viewer;
    viewer.setSceneData(model);
    viewer.addEventHandler(new osgViewer::StatsHandler);
    viewer.setCameraManipulator(argc > 2 ? path_player(argv[2]) : new osgGA::TrackballManipulator);
    sightline::osg_culling::Culler culler(model, "tcp://127.0.0.1:5571");
    culler.cull(viewer.getCamera());
    return viewer.run();
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
