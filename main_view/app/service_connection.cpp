#include "main_view/app/service_connection.hpp"

#include <algorithm>

#include <glm/gtc/matrix_transform.hpp>

#include "common/error.hpp"

namespace sightline {
namespace {

SessionOptions session_options(const std::string& endpoint, const Scene& scene,
                               const ServiceOptions& options) {
  SessionOptions session;
  session.endpoint = endpoint;
  session.scene_digest = scene.digest;
  session.object_count = scene.object_count();
  if (!options.key_file.empty()) session.link.curve = read_curve_keys(options.key_file.string());
  return session;
}

}  // namespace

ServiceConnection::ServiceConnection(const std::filesystem::path& scene_file, const Scene& scene,
                                     const ServiceOptions& options)
    : options_(options),
      daemon_(options.spawn ? std::make_unique<SpawnedDaemon>(scene_file, options) : nullptr),
      endpoint_(daemon_ ? daemon_->endpoint() : options.connect),
      session_(session_options(endpoint_, scene, options)) {}

void ServiceConnection::require_open(double timeout_s) {
  switch (session_.wait_until_open(timeout_s)) {
    case SessionState::open:
      if (!daemon_) require_settings(options_, *session_.welcome());
      return;
    case SessionState::refused:
      throw InputError(endpoint_ + " refuses the session: " + to_string(session_.refusal()->reason) + ", " +
                       session_.refusal()->text);
    case SessionState::connecting:
      if (session_.refusal()) {
        throw MachineError(endpoint_ + " refuses the session for now: " + session_.refusal()->text);
      }
      throw MachineError(endpoint_ + ": no control_view answers; start one there or use --spawn");
  }
}

CullingOptions culling_options_of(const ServiceOptions& options) {
  CullingOptions culling = culling_options_of_preset(options.preset.value_or("default"));
  if (options.predictor) {
    culling.predictor = *options.predictor == "adaptive" ? PredictorKind::adaptive : PredictorKind::fixed;
  }
  if (options.predictor_order) culling.predictor_order = *options.predictor_order;
  if (options.predictor_window) culling.predictor_window = *options.predictor_window;
  if (options.guard_deg) {
    culling.min_guard_rad = glm::radians(*options.guard_deg);
    culling.max_guard_rad = std::max(culling.max_guard_rad, culling.min_guard_rad);
  }
  return culling;
}

std::vector<RigEye> rig_of(const SceneOptions& scene, const ReplayOptions& replay) {
  const glm::dmat4 clip_from_camera = scene.clip_from_camera();
  if (!replay.stereo) return {{glm::dmat4(1.0), clip_from_camera}};
  // An eye to the left of the head sees the head's frame moved to the right.
  const glm::dvec3 half(0.5 * replay.eye_separation_m, 0.0, 0.0);
  return {{glm::translate(glm::dmat4(1.0), half), clip_from_camera},
          {glm::translate(glm::dmat4(1.0), -half), clip_from_camera}};
}

}  // namespace sightline
