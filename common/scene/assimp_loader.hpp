#pragma once

#include <filesystem>

#include "common/scene/load_scene.hpp"

namespace sightline {

/// load_scene for what assimp reads. Axes and units stay as assimp gives them; of a material the diffuse
/// colour, its opacity (below 1, or given by a map: BLEND, which hides nothing) and the two-sided flag are
/// taken, textures are not.
[[nodiscard]] Scene load_with_assimp(const std::filesystem::path& file, const SceneLoadOptions& options);

}  // namespace sightline
