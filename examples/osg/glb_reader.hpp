#pragma once

#include <filesystem>
#include <osg/Node>
#include <osg/ref_ptr>
#include <string>
#include <vector>

namespace sightline::osg_example {

/// Reads a binary glTF 2.0 file into a scene graph: a MatrixTransform where a node has a matrix or its mesh
/// is far from the origin, a Geode per node with a mesh, a Geometry per primitive. Debian's OpenSceneGraph
/// has no reader of its own for it.
///
/// Knows positions, indices, base colours, alphaMode and doubleSided; no textures, normals, skins or sparse
/// accessors, and what lies outside the file. Metres, Y up, as in the file.
/// Throws std::runtime_error naming the file and what is wrong with it.
[[nodiscard]] osg::ref_ptr<osg::Node> read_glb(const std::filesystem::path& file);

/// The same from a file's bytes; `name` is for errors.
[[nodiscard]] osg::ref_ptr<osg::Node> read_glb(const std::vector<char>& bytes, const std::string& name);

}  // namespace sightline::osg_example
