#include "main_view/app/why_command.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <ostream>

#include <glm/gtc/matrix_transform.hpp>

#include "common/camera_path.hpp"
#include "common/scene/load_scene.hpp"
#include "main_view/app/service_connection.hpp"
#include "main_view/app/why_text.hpp"

namespace sightline {
namespace {

constexpr double k_answer_timeout_s = 60.0;  // a software engine on a huge scene is slow
constexpr std::uint64_t k_nonce = 1;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Some frames of a path as a client that waits for each answer sees them.
class WaitingClient {
 public:
  WaitingClient(const WhyOptions& options, const Scene& scene)
      : options_(options),
        connection_(options.scene.scene, scene, options.service.on_virtual_clock()),
        core_(culling_options_of(options.service), rig_of(options.scene, options.replay)) {
    connection_.require_open(k_answer_timeout_s);
  }

  void see(double time_s, const Pose& pose) {
    core_.add_pose({time_s, pose});
    time_s_ = time_s;
    eyes_ = eyes_of(pose, core_.rig());
    const ViewRequest request = core_.make_exact_request(time_s, options_.scene.size, eyes_);
    CullingSession& session = connection_.session();
    session.send(request, time_s);
    const std::optional<Answer> answer = session.wait_for(request.request_seq, k_answer_timeout_s);
    if (!answer) throw silence("request " + std::to_string(request.request_seq));
    core_.accept(request, time_s, answer->set, time_s);
  }

  [[nodiscard]] ClientVerdict verdict(ObjectId id, const Aabb& world_bounds) const {
    return verdict_of(id, world_bounds, eyes_, core_.decide(time_s_, eyes_));
  }

  [[nodiscard]] WhyAnswer ask(ObjectId id) {
    CullingSession& session = connection_.session();
    session.send_why(k_nonce, 0, id);
    for (const auto start = std::chrono::steady_clock::now(); seconds_since(start) < k_answer_timeout_s;) {
      session.wait(0.1);
      for (WhyAnswer& answer : session.take_why_answers()) {
        if (answer.nonce == k_nonce) return std::move(answer);
      }
      if (session.state() != SessionState::open) break;
    }
    throw silence("the question why (older daemons know none)");
  }

 private:
  [[nodiscard]] MachineError silence(const std::string& asked) const {
    return MachineError(connection_.endpoint() + ": no answer to " + asked +
                        "; is control_view still running?");
  }

  const WhyOptions& options_;
  ServiceConnection connection_;
  CullingCore core_;
  double time_s_ = 0.0;
  std::vector<Eye> eyes_;
};

void print(std::ostream& out, const WhyLine& line) {
  std::string key = line.key;
  key.resize(std::max<std::size_t>(key.size() + 1, 11), ' ');
  out << key << line.text << '\n';
}

}  // namespace

ExitCode run_why(const WhyOptions& options, std::ostream& out) {
  const CameraPath path = read_camera_path(options.scene.path);
  const std::uint32_t frames = options.replay.frame_count(path.duration_s());
  if (options.frame >= frames) {
    throw InputError("--frame: the path has frames 0 to " + std::to_string(frames - 1) + " at this rate");
  }
  const Scene scene = load_scene(options.scene.scene);
  const ObjectId id = find_object(scene, options.object);

  WaitingClient client(options, scene);
  const std::uint32_t first = options.frame - std::min(options.frame, k_why_lead_frames);
  for (std::uint32_t frame = first; frame <= options.frame; ++frame) {
    const double time_s = frame / options.replay.rate_hz;
    client.see(time_s, path.at(options.replay.start_s + time_s));
  }
  const Aabb world_bounds =
      transformed(scene.object_bounds[index_of(id)], glm::translate(glm::dmat4(1.0), scene.world_origin_m));
  print(out, {"object", called(id, scene)});
  print(out, line_of(client.verdict(id, world_bounds)));
  for (const WhyLine& line : lines_of(client.ask(id), scene)) print(out, line);
  return ExitCode::done;
}

}  // namespace sightline
