#include "tests/quality/moving_world.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <glm/ext/matrix_transform.hpp>

namespace sightline::testing {
namespace {

std::unique_ptr<VisibilityEngine> engine_of(const Scene& scene, const std::string& name) {
  EngineOptions options;
  options.engine = name;
  options.threads = 1;
  return make_engine(scene, options);
}

std::vector<RigEye> rig_of(const WorldSetup& setup) {
  const double aspect = static_cast<double>(setup.main_size.width) / setup.main_size.height;
  const glm::dmat4 projection = clip_from_camera(Perspective{}, aspect);
  if (setup.eye_separation_m == 0.0) return {{glm::dmat4(1.0), projection}};
  // An eye to the left of the head sees the head's frame moved to the right.
  const glm::dvec3 half(0.5 * setup.eye_separation_m, 0.0, 0.0);
  return {{glm::translate(glm::dmat4(1.0), half), projection},
          {glm::translate(glm::dmat4(1.0), -half), projection}};
}

}  // namespace

WorldSetup world_setup(const std::string& engine, double latency_s) {
  WorldSetup setup;
  setup.engine = engine;
  setup.latency_s = latency_s;
  setup.pipeline.size = setup.main_size;
  // The guard band makes pixels coarser, and this is not about coarse pixels.
  setup.culling.min_guard_rad = 0.0;
  return setup;
}

bool WorldFrame::draws(ObjectId id) const {
  return std::binary_search(drawn.begin(), drawn.end(), id);
}

bool WorldFrame::shows(ObjectId id) const {
  return std::binary_search(visible.begin(), visible.end(), id);
}

MovingWorld::MovingWorld(const Scene& scene, const std::vector<Actor>& actors, const WorldSetup& setup)
    : scene_(scene),
      actors_(actors),
      setup_(setup),
      served_(served_scene({scene.digest, scene.object_count()}, engine_of(scene, setup.engine))),
      judge_(engine_of(scene, "raster")),
      hierarchy_(scene.object_bounds),
      draw_list_(hierarchy_, scene.world_origin_m),
      core_(setup.culling, rig_of(setup)),
      daemon_([this](const ViewRequest& request) { return session_->ask(request); }, setup.control_rate_hz,
              setup.latency_s) {
  session_ = std::make_unique<InProcessSession>(++session_id_, served_, setup_.pipeline);
  const glm::dmat4 world_from_scene = glm::translate(glm::dmat4(1.0), scene.world_origin_m);
  std::vector<MovedObject> declared;
  for (const Actor& actor : actors) {
    const glm::dmat4 file = world_from_scene * scene.objects[index_of(actor.id)].scene_from_object;
    placed_[actor.id] = file;
    if (actor.declared) declared.push_back(moved(actor.id, file));
  }
  core_.declare_objects(declared);
  truth_.owner = 1;
}

MovedObject MovingWorld::moved(ObjectId id, const glm::dmat4& placement) const {
  return {id, glm::dmat4x3(placement), scene_.meshes[scene_.objects[index_of(id)].mesh].bounds};
}

void MovingWorld::lose_the_daemon() {
  session_ = std::make_unique<InProcessSession>(++session_id_, served_, setup_.pipeline);
  core_.forget_sets();
}

void MovingWorld::move_actors(double now_s) {
  const glm::dmat4 scene_from_world = glm::translate(glm::dmat4(1.0), -scene_.world_origin_m);
  std::vector<MovedObject> changed;
  for (const Actor& actor : actors_) {
    const std::optional<glm::dmat4> placement = actor.placement(now_s);
    if (absent_[actor.id] != !placement) {
      absent_[actor.id] = !placement;
      placement ? core_.show_objects({&actor.id, 1}) : core_.hide_objects({&actor.id, 1});
      ++truth_.version;
    }
    if (!placement || *placement == placed_[actor.id]) continue;
    placed_[actor.id] = *placement;
    changed.push_back(moved(actor.id, *placement));
    const Aabb bounds = transformed(changed.back().object_bounds, scene_from_world * *placement);
    hierarchy_.move({&actor.id, 1}, {&bounds, 1});
    ++truth_.version;
  }
  core_.move_objects(now_s, changed);
  truth_.moves.clear();
  truth_.hidden.clear();
  for (const auto& [id, placement] : placed_) truth_.moves.push_back({id, glm::dmat4x3(placement)});
  for (const auto& [id, absent] : absent_) {
    if (absent) truth_.hidden.push_back(id);
  }
}

WorldFrame MovingWorld::step(const Pose& head) {
  const double now_s = frame_++ / setup_.frame_rate_hz;
  take_deliveries(daemon_, core_, now_s);
  core_.add_pose({now_s, head});
  move_actors(now_s);
  const ViewRequest request = core_.make_request(now_s, setup_.main_size);
  daemon_.issue(request, now_s);
  take_deliveries(daemon_, core_,
                  now_s);  // with no latency the answer to this very frame's request is here already

  const std::vector<Eye> eyes = eyes_of(head, core_.rig());
  const FrameDecision decision = core_.decide(now_s, eyes);
  PixelCounts truth;
  judge_->apply(truth_);
  (void)judge_->count({eyes, setup_.main_size, {}}, truth);

  WorldFrame frame;
  frame.time_s = now_s;
  frame.fallback = decision.fallback;
  frame.boxed = request.boxed.size();
  frame.drawn = draw_list_.visible(eyes, decision);
  frame.visible = truth.ids;
  for (std::size_t i = 0; i < truth.ids.size(); ++i) {
    if (!frame.draws(truth.ids[i])) frame.missed[truth.ids[i]] = truth.pixels[i];
  }
  return frame;
}

std::vector<WorldFrame> run_world(const Scene& scene, const std::vector<Actor>& actors,
                                  const WorldSetup& setup, const std::function<Pose(double)>& motion,
                                  double duration_s) {
  MovingWorld world(scene, actors, setup);
  std::vector<WorldFrame> frames;
  const auto count = static_cast<int>(duration_s * setup.frame_rate_hz);
  for (int i = 0; i < count; ++i) frames.push_back(world.step(motion(i / setup.frame_rate_hz)));
  return frames;
}

}  // namespace sightline::testing
