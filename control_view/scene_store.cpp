#include "control_view/scene_store.hpp"

#include <algorithm>
#include <utility>

namespace sightline {

SceneStore::SceneStore(ServedScenePtr own) : own_(std::move(own)) {}

void SceneStore::add(ServedScenePtr scene) {
  if (find(scene->identity.digest) == nullptr) scenes_.push_back(std::move(scene));
}

ServedScenePtr SceneStore::find(const SceneDigest& digest) const noexcept {
  if (own_ != nullptr && own_->identity.digest == digest) return own_;
  const auto found = std::find_if(scenes_.begin(), scenes_.end(), [&](const ServedScenePtr& scene) {
    return scene->identity.digest == digest;
  });
  return found == scenes_.end() ? nullptr : *found;
}

std::uint64_t SceneStore::byte_count() const noexcept {
  std::uint64_t bytes = 0;
  for (const ServedScenePtr& scene : scenes_) bytes += scene->byte_count;
  return bytes;
}

bool SceneStore::make_room(std::size_t count, std::uint64_t byte_count, std::size_t most_scenes,
                           std::uint64_t most_bytes, double now_s) {
  if (count > most_scenes || byte_count > most_bytes) return false;
  while (scenes_.size() + count > most_scenes || this->byte_count() + byte_count > most_bytes) {
    const auto longest_unused =
        std::min_element(scenes_.begin(), scenes_.end(), [](const auto& a, const auto& b) {
          return std::pair(a->sessions, a->last_used_s) < std::pair(b->sessions, b->last_used_s);
        });
    if (longest_unused == scenes_.end() || (*longest_unused)->sessions > 0 ||
        now_s - (*longest_unused)->last_used_s < k_idle_s) {
      return false;
    }
    scenes_.erase(longest_unused);
  }
  return true;
}

}  // namespace sightline
