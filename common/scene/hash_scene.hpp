#pragma once

#include "common/scene/scene.hpp"

namespace sightline {

/// XXH3-128 over what decides visibility, in an order and a form that do not depend on how the arrays are cut
/// up. Requires a valid scene (finish_scene checks before it hashes).
[[nodiscard]] SceneDigest hash_scene(const Scene& scene);

}  // namespace sightline
