#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "control_view/served_scene.hpp"
#include "protocol/messages.hpp"

namespace sightline {

/// The bytes of an uploaded scene, aligned for its reader. Memory is taken as chunks arrive, by the page, so
/// an offer of much costs nothing.
struct SceneBytes {
  std::unique_ptr<std::uint8_t[]> bytes;
  std::uint64_t byte_count = 0;
};

/// What became of an upload.
struct BuiltScene {
  SceneDigest digest{};
  /// The scene; or the chunks that are not what the offer said, with which nothing was made; or why no scene
  /// can be made of bytes that are what the offer said.
  std::variant<ServedScenePtr, std::vector<std::uint32_t>, std::string> result;
  SceneBytes bytes;  ///< given back where chunks are wrong
};

/// Checks uploads and makes their engines, one after another, on a thread of its own: sessions on other
/// scenes are answered meanwhile.
class SceneBuilder {
 public:
  /// Called on the builder's thread; what it makes is used on another.
  using MakeEngine = std::function<std::unique_ptr<VisibilityEngine>(const Scene&)>;

  explicit SceneBuilder(MakeEngine make_engine);
  /// Waits for the scene that is being built.
  ~SceneBuilder();
  SceneBuilder(const SceneBuilder&) = delete;
  SceneBuilder& operator=(const SceneBuilder&) = delete;

  void build(const SceneOffer& offer, SceneBytes bytes);
  /// One that is done, if any.
  [[nodiscard]] std::optional<BuiltScene> take();

 private:
  struct Job {
    SceneOffer offer;
    SceneBytes bytes;
  };
  void run();
  [[nodiscard]] BuiltScene build(Job job) const;

  MakeEngine make_engine_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  std::deque<BuiltScene> done_;
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace sightline
