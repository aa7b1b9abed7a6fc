#include "tests/quality/virtual_service.hpp"

#include <algorithm>
#include <stdexcept>

#include <glm/ext/matrix_transform.hpp>

#include "control_view/daemon_options.hpp"
#include "control_view/engines/raster/raster_engine.hpp"

namespace sightline::testing {
namespace {

constexpr std::uint64_t k_session_id = 1;

/// One thread each: what is tested must not depend on cores, and a test shares them with others.
std::unique_ptr<VisibilityEngine> one_threaded_raster(const Scene& scene) {
  EngineOptions options;
  options.threads = 1;
  return make_raster_engine(scene, options);
}

ServiceSetup setup_of(std::string_view preset, double latency_s) {
  const DaemonOptions daemon = preset_options(preset);
  ServiceSetup setup;
  setup.culling = culling_options_of_preset(preset);
  setup.pipeline.size = {256, 192};
  setup.pipeline.filter_length = daemon.filter;
  setup.pipeline.threshold_pixels = daemon.threshold;
  setup.pipeline.refine = daemon.refine;
  if (!daemon.open) setup.pipeline.sample_px.reset();
  setup.pipeline.extents = daemon.extents;
  setup.latency_s = latency_s;
  return setup;
}

std::vector<RigEye> rig_of(const ServiceSetup& setup) {
  const double aspect = static_cast<double>(setup.main_size.width) / setup.main_size.height;
  const glm::dmat4 projection = clip_from_camera(setup.perspective, aspect);
  if (setup.eye_separation_m == 0.0) return {{glm::dmat4(1.0), projection}};
  // An eye to the left of the head sees the head's frame moved to the right.
  const glm::dvec3 half(0.5 * setup.eye_separation_m, 0.0, 0.0);
  return {{glm::translate(glm::dmat4(1.0), half), projection},
          {glm::translate(glm::dmat4(1.0), -half), projection}};
}

}  // namespace

ServiceSetup default_setup(double latency_s) {
  return setup_of("default", latency_s);
}

ServiceSetup avango_setup(double latency_s) {
  return setup_of("avango", latency_s);
}

VirtualService::VirtualService(const Scene& scene, const ServiceSetup& setup)
    : scene_(scene),
      setup_(setup),
      judge_(one_threaded_raster(scene)),
      session_(k_session_id, served_scene({scene.digest, scene.object_count()}, one_threaded_raster(scene)),
               setup.pipeline),
      hierarchy_(scene.object_bounds),
      draw_list_(hierarchy_, scene.world_origin_m),
      core_(setup.culling, rig_of(setup)),
      daemon_([this](const ViewRequest& request) { return session_.ask(request); }, setup.control_rate_hz,
              setup.latency_s) {}

FrameOutcome VirtualService::step(const Pose& head) {
  const double now_s = frame_++ / setup_.frame_rate_hz;
  take_deliveries(daemon_, core_, now_s);
  core_.add_pose({now_s, head});
  daemon_.issue(core_.make_request(now_s, setup_.main_size), now_s);
  take_deliveries(daemon_, core_,
                  now_s);  // with no latency the answer to this very frame's request is here already

  eyes_ = eyes_of(head, core_.rig());
  const FrameDecision decision = core_.decide(now_s, eyes_);
  drawn_ = draw_list_.visible(eyes_, decision);
  in_frustum_ = draw_list_.in_frustum(eyes_);
  (void)judge_->count({eyes_, setup_.main_size, {}}, truth_);

  FrameOutcome outcome;
  outcome.time_s = now_s;
  outcome.fallback = decision.fallback;
  outcome.drawn_objects = static_cast<std::uint32_t>(drawn_.size());
  outcome.visible_objects = static_cast<std::uint32_t>(truth_.ids.size());
  outcome.in_frustum_objects = static_cast<std::uint32_t>(in_frustum_.size());
  for (std::size_t i = 0; i < truth_.ids.size(); ++i) {
    if (std::binary_search(drawn_.begin(), drawn_.end(), truth_.ids[i])) continue;
    outcome.missed[truth_.ids[i]] = truth_.pixels[i];
    outcome.wrong_pixels += truth_.pixels[i];
  }
  return outcome;
}

}  // namespace sightline::testing
