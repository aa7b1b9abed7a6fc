#pragma once

#include <cstdint>
#include <string>

#include "common/scene/scene.hpp"
#include "control_view/scene_roles.hpp"
#include "protocol/scene_data.hpp"

namespace sightline {

/// Why a scene asks for more work than its bytes justify: meshes and primitives are runs, and runs may
/// overlap, so a few bytes could name billions of triangles. Each list may be used k_most_uses times over.
/// Empty where all is well. To be asked before triangle_count() and scene_of().
[[nodiscard]] std::string excess_of(const SceneData& data);
inline constexpr std::uint64_t k_most_uses = 4;

/// A scene for an engine. Objects that hide nothing, and levels of detail, get blended copies of their
/// materials: a blended fragment is tested and never an occluder. Spare objects have an empty mesh. The
/// scene frame is the world frame, unless the scene lies far from the world's origin (see Scene).
/// Throws InputError that begins with `name` for what finish_scene refuses.
[[nodiscard]] Scene scene_of(SceneData data, const std::string& name);

}  // namespace sightline
