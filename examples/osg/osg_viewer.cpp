// An OpenSceneGraph viewer: osg_viewer MODEL [PATH.csv]

#include <exception>
#include <iostream>
#include <osgGA/TrackballManipulator>
#include <osgViewer/Viewer>
#include <osgViewer/ViewerEventHandlers>

#include "examples/osg/load_model.hpp"

using namespace sightline::osg_example;

int main(int argc, char** argv) {
  try {
    if (argc < 2) throw std::runtime_error("usage: osg_viewer MODEL [PATH.csv]");
    const osg::ref_ptr<osg::Node> model = load_model(argv[1]);
    osgViewer::Viewer viewer;
    viewer.setSceneData(model);
    viewer.addEventHandler(new osgViewer::StatsHandler);
    viewer.setCameraManipulator(argc > 2 ? path_player(argv[2]) : new osgGA::TrackballManipulator);
    return viewer.run();
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
