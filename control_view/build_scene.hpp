#pragma once

#include <functional>
#include <memory>
#include <string>
#include <variant>

#include "control_view/scene_bytes.hpp"
#include "control_view/served_scene.hpp"
#include "protocol/messages.hpp"

namespace sightline {

/// An upload that is there and right, chunk by chunk.
struct FinishedUpload {
  SceneOffer offer;
  SceneBytes bytes;
};

struct BuiltScene {
  SceneDigest digest{};
  std::variant<ServedScenePtr, std::string> result;  ///< or why no scene can be made of these bytes
};

/// May throw: then no scene is made, and the exception's text says why.
using MakeEngine = std::function<std::unique_ptr<VisibilityEngine>(const Scene&)>;

/// Makes a scene of an upload, and its engine; on whichever thread it likes, for the scene's first user.
/// Does not throw: what goes wrong is of this scene alone.
[[nodiscard]] BuiltScene build_scene(FinishedUpload upload, const MakeEngine& make_engine);

}  // namespace sightline
