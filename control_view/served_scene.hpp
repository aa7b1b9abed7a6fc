#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include "common/scene_digest.hpp"
#include "control_view/engine.hpp"
#include "control_view/scene_roles.hpp"

namespace sightline {

/// What the service must know of a scene: its geometry is the engine's.
struct SceneIdentity {
  SceneDigest digest{};
  std::uint32_t object_count = 0;  ///< spare ones included
};

/// A scene that sessions can be opened on. They share it, and nothing of it but the engine's state changes.
struct ServedScene {
  SceneIdentity identity;
  SceneRoles roles;
  std::unique_ptr<VisibilityEngine> engine;
  std::uint64_t byte_count = 0;  ///< of the upload; 0 for the scene that the daemon was started with
  std::uint32_t sessions = 0;    ///< that are open on it
  double last_used_s = 0.0;      ///< when the last of these was closed
};
using ServedScenePtr = std::shared_ptr<ServedScene>;

[[nodiscard]] inline ServedScenePtr served_scene(const SceneIdentity& identity,
                                                 std::unique_ptr<VisibilityEngine> engine) {
  auto scene = std::make_shared<ServedScene>();
  scene->identity = identity;
  scene->engine = std::move(engine);
  return scene;
}

}  // namespace sightline
