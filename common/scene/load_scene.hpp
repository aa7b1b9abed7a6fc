#pragma once

#include <filesystem>
#include <functional>

#include "common/scene/scene.hpp"

namespace sightline {

struct SceneLoadOptions {
  /// Normals, texture coordinates and textures that only shading needs, and object names. Without it they are
  /// kept only where a MASK material needs them, which is what a visibility daemon wants. The digest is the
  /// same either way.
  bool shading = true;
};

/// Reads a scene file: .glb and .gltf with tinygltf; .obj, .ply, .stl, .fbx, .dae, .ifc with assimp.
///
/// An object is a node with a mesh (in glTF, each instance of EXT_mesh_gpu_instancing is one too); a mesh's
/// primitives stay together. Strips, fans and non-indexed primitives become indexed triangles; points and
/// lines are dropped. Object order is the file's node order in a depth-first walk of the scene, so that both
/// processes number objects alike.
///
/// Throws InputError, one line that begins with the file's name, for anything that cannot be drawn as stated:
/// see finish_scene, and also a missing, truncated or lying file, an unsupported required extension, a node
/// cycle, no mesh at all. Never allocates more than the file's own sizes justify.
[[nodiscard]] Scene load_scene(const std::filesystem::path& file, const SceneLoadOptions& options = {});

}  // namespace sightline
