#pragma once

#include <string>

#include "common/scene/scene.hpp"
#include "control_view/scene_roles.hpp"
#include "protocol/scene_data.hpp"

namespace sightline {

/// A scene for an engine. Objects that hide nothing, and levels of detail, get blended copies of their
/// materials: a blended fragment is tested and never an occluder. Spare objects have an empty mesh. The
/// scene frame is the world frame, unless the scene lies far from the world's origin (see Scene).
/// Throws InputError that begins with `name` for what finish_scene refuses.
[[nodiscard]] Scene scene_of(SceneData data, const std::string& name);

}  // namespace sightline
