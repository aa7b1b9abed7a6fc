#pragma once

#include <filesystem>

#include "common/scene/load_scene.hpp"

namespace sightline {

/// load_scene for .glb and .gltf.
[[nodiscard]] Scene load_gltf(const std::filesystem::path& file, const SceneLoadOptions& options);

}  // namespace sightline
