#pragma once

#include <filesystem>

#include "common/scene/scene.hpp"

namespace sightline {

/// Writes a finished scene as one binary glTF 2.0 file: a node per object in object order, meshes shared as
/// they are in the scene, textures as PNG. load_scene reads it back to an equal digest, provided that every
/// mesh is used and primitives lie in mesh order, as loaders and generators make them. The JSON is written
/// node by node and the arrays straight from the scene, so that memory stays small. Throws InputError when
/// the file cannot be written or would exceed the 4 GB of the format.
void write_glb(const std::filesystem::path& file, const Scene& scene);

}  // namespace sightline
