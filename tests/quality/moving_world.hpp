#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/object_hierarchy.hpp"
#include "common/scene/scene.hpp"
#include "main_view/app/draw_list.hpp"
#include "main_view/app/virtual_daemon.hpp"
#include "main_view/client/culling_core.hpp"
#include "tests/quality/in_process_session.hpp"

namespace sightline::testing {

/// An object that moves: where it is at a time, world frame; nothing when it is not there.
struct Actor {
  ObjectId id{};
  std::function<std::optional<glm::dmat4>(double time_s)> placement;
  bool declared = true;  ///< to the client before the first request
};

struct WorldSetup {
  std::string engine = "raster";
  CullingOptions culling;
  PipelineOptions pipeline;  ///< as large as the main image, so that nothing is lost to a coarse one
  ImageSize main_size{320, 240};
  double frame_rate_hz = 60.0;
  double control_rate_hz = 30.0;
  double latency_s = 0.05;
  double eye_separation_m = 0.0;  ///< 0: a single eye
};

[[nodiscard]] WorldSetup world_setup(const std::string& engine, double latency_s);

/// One frame against the truth.
struct WorldFrame {
  double time_s = 0.0;
  std::map<ObjectId, std::uint32_t> missed;  ///< visible, not drawn, with their pixels
  std::vector<ObjectId> drawn, visible;      ///< ascending
  std::size_t boxed = 0;                     ///< objects that this frame's request carried as boxes
  Fallback fallback = Fallback::none;

  [[nodiscard]] bool draws(ObjectId id) const;
  [[nodiscard]] bool shows(ObjectId id) const;
};

/// The whole service in one process on a virtual clock, with objects that move. The judge is an engine of its
/// own at the main image's size, whose objects stand where the actors are in that very frame.
class MovingWorld {
 public:
  /// All must outlive this.
  MovingWorld(const Scene& scene, const std::vector<Actor>& actors, const WorldSetup& setup);

  WorldFrame step(const Pose& head);
  /// The daemon is gone and another comes in its place.
  void lose_the_daemon();

 private:
  void move_actors(double now_s);
  [[nodiscard]] MovedObject moved(ObjectId id, const glm::dmat4& placement) const;

  const Scene& scene_;
  const std::vector<Actor>& actors_;
  WorldSetup setup_;
  ServedScenePtr served_;
  std::unique_ptr<VisibilityEngine> judge_;
  std::unique_ptr<InProcessSession> session_;
  std::uint64_t session_id_ = 0;
  ObjectHierarchy hierarchy_;
  DrawListBuilder draw_list_;
  CullingCore core_;
  VirtualDaemon daemon_;
  SceneEdits truth_;
  std::map<ObjectId, glm::dmat4> placed_;
  std::map<ObjectId, bool> absent_;
  std::uint32_t frame_ = 0;
};

/// Runs it; `motion` is where the camera is.
[[nodiscard]] std::vector<WorldFrame> run_world(const Scene& scene, const std::vector<Actor>& actors,
                                                const WorldSetup& setup,
                                                const std::function<Pose(double)>& motion, double duration_s);

}  // namespace sightline::testing
