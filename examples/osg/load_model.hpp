#pragma once

#include <filesystem>
#include <osg/Node>
#include <osg/ref_ptr>
#include <osgGA/CameraManipulator>

namespace sightline::osg_example {

/// A model of any kind that OpenSceneGraph's plugins read, or a .glb with normals added.
/// Throws std::runtime_error naming the file.
[[nodiscard]] osg::ref_ptr<osg::Node> load_model(const std::filesystem::path& file);

/// Plays the camera path of a CSV (see camera_path.hpp) over and over.
/// Throws std::runtime_error naming the file.
[[nodiscard]] osg::ref_ptr<osgGA::CameraManipulator> path_player(const std::filesystem::path& file);

}  // namespace sightline::osg_example
