#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "control_view/served_scene.hpp"

namespace sightline {

/// The scenes that this daemon serves, by digest. The one it was started with stays; those that came over
/// the wire make room for others when no session has used them for a while.
class SceneStore {
 public:
  /// How long a scene is kept for a client that comes back, seconds.
  static constexpr double k_idle_s = 60.0;

  SceneStore() = default;
  /// With the daemon's own scene, for as long as the store lives.
  explicit SceneStore(ServedScenePtr own);

  void add(ServedScenePtr scene);
  /// Null when there is none of that digest.
  [[nodiscard]] ServedScenePtr find(const SceneDigest& digest) const noexcept;
  /// The daemon's own, or null.
  [[nodiscard]] const ServedScenePtr& own() const noexcept { return own_; }

  /// Forgets idle scenes, the longest unused first, until `count` more of `byte_count` in all fit into the
  /// limits. Returns whether they do.
  [[nodiscard]] bool make_room(std::size_t count, std::uint64_t byte_count, std::size_t most_scenes,
                               std::uint64_t most_bytes, double now_s);

  /// Of those that came over the wire.
  [[nodiscard]] std::size_t size() const noexcept { return scenes_.size(); }
  [[nodiscard]] std::uint64_t byte_count() const noexcept;

 private:
  ServedScenePtr own_;
  std::vector<ServedScenePtr> scenes_;
};

}  // namespace sightline
