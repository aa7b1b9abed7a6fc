#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <stdexcept>
#include <vector>

#include "common/error.hpp"
#include "control_view/engine.hpp"

namespace sightline::test {

inline constexpr std::uint32_t k_object_count = 5000;

/// An eye that a FakeEngine tells apart from others by `place`.
inline Eye eye_at(double place) {
  Eye eye;
  eye.camera_from_world[3][0] = -place;
  eye.clip_from_camera = clip_from_camera(Perspective{}, 4.0 / 3.0);
  return eye;
}

/// Ids, ascending, that depend on `seed` alone: about one object in fifty.
inline std::vector<ObjectId> ids_of(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<ObjectId> ids;
  for (std::uint32_t id = 0; id < k_object_count; ++id) {
    if (random() % 50 == 0) ids.push_back(ObjectId{id});
  }
  return ids;
}

inline std::uint64_t seed_of(double place, const std::optional<ImageWindow>& window) {
  const auto seed = static_cast<std::uint64_t>(std::llround(std::abs(place) * 1000.0));
  return window ? seed * 1000003 + window->x * 65537 + window->y + 1 : seed;
}

/// Sees ids_of the eyes' places, and every object that was moved or is boxed.
class FakeEngine final : public VisibilityEngine {
 public:
  void apply(const SceneEdits& edits) override {
    ++apply_count;
    edits_ = edits;
  }

  [[nodiscard]] const SceneEdits& edits() const noexcept { return edits_; }

  EngineStats count(const ViewQuery& query, PixelCounts& counts) override {
    ++count_calls;
    windows.push_back(query.window);
    sizes.push_back(query.size);
    last_eyes.assign(query.eyes.begin(), query.eyes.end());
    last_boxed.assign(query.boxed.begin(), query.boxed.end());
    if (lose_context) throw MachineError("the context is lost");
    if (throw_once) {
      throw_once = false;
      throw std::runtime_error("something odd in this one request");
    }
    std::vector<ObjectId> seen;
    for (const Eye& eye : query.eyes) {
      const auto ids = ids_of(seed_of(eye.camera_from_world[3][0], query.window));
      seen.insert(seen.end(), ids.begin(), ids.end());
    }
    for (const ObjectMove& move : edits_.moves) seen.push_back(move.id);
    for (const BoxedObject& object : query.boxed) seen.push_back(object.id);
    std::sort(seen.begin(), seen.end());
    seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
    counts.clear();
    for (const ObjectId id : seen) {
      counts.ids.push_back(id);
      counts.pixels.push_back(1 + index_of(id) % 7);
    }
    EngineStats stats;
    stats.drawn_objects = static_cast<std::uint32_t>(seen.size());
    return stats;
  }

  int apply_count = 0;
  int count_calls = 0;
  bool throw_once = false;
  bool lose_context = false;
  std::vector<std::optional<ImageWindow>> windows;
  std::vector<ImageSize> sizes;
  std::vector<Eye> last_eyes;
  std::vector<BoxedObject> last_boxed;

 private:
  SceneEdits edits_;
};

}  // namespace sightline::test
