#include "main_view/app/audit_command.hpp"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iostream>

#include <nlohmann/json.hpp>

#include "common/camera_path.hpp"
#include "common/scene/load_scene.hpp"
#include "common/statistics.hpp"
#include "main_view/app/depth_complexity.hpp"
#include "main_view/app/draw_list.hpp"
#include "main_view/app/frame_judge.hpp"
#include "main_view/app/progress.hpp"
#include "main_view/app/quality.hpp"
#include "main_view/app/report.hpp"
#include "main_view/app/service_connection.hpp"
#include "main_view/app/virtual_daemon.hpp"

namespace sightline {
namespace {

constexpr double k_answer_timeout_s = 60.0;  // real seconds; a software engine on a huge scene is slow
// Frames between two that are judged against every object rather than those in the view frustum, and whose
// depth complexity is measured: either costs more than the rest of the frame.
constexpr std::uint32_t k_thorough_every = 30;

using RealClock = std::chrono::steady_clock;

double clock_s() {
  return std::chrono::duration<double>(RealClock::now().time_since_epoch()).count();
}

double seconds_since(RealClock::time_point start) {
  return std::chrono::duration<double>(RealClock::now() - start).count();
}

/// Everything the replay holds; made once, stepped frame by frame.
class Audit {
 public:
  explicit Audit(const AuditOptions& options)
      : options_(options),
        path_(read_camera_path(options.scene.path)),
        frame_count_(options.replay.frame_count(path_.duration_s())),
        scene_(load_scene(options.scene.scene, {.shading = false})),
        connection_(options.scene.scene, scene_, options.service.on_virtual_clock()),
        context_(gl::make_offscreen_context(options.scene.context)),
        gpu_scene_(scene_, false),
        judge_(scene_, gpu_scene_, options.scene.size),
        layers_(options.scene.size),
        draw_list_(judge_.hierarchy(), scene_.world_origin_m),
        core_(culling_options_of(options.service), rig_of(options.scene, options.replay)),
        daemon_([this](const ViewRequest& request) { return ask(request); }, options.service.control_rate_hz,
                options.latency_ms / 1000.0) {
    connection_.require_open(k_answer_timeout_s);
  }

  [[nodiscard]] std::uint32_t frame_count() const noexcept { return frame_count_; }

  /// One frame: camera -> request -> (daemon, virtual latency) -> sets -> decision -> draw list -> verdict.
  FrameRecord step(std::uint32_t frame) {
    const double now_s = frame / options_.replay.rate_hz;
    const double path_s = options_.replay.start_s + (options_.still ? 0.0 : now_s);
    const Pose head = path_.at(path_s);

    take_deliveries(now_s);
    core_.add_pose({now_s, head});
    daemon_.issue(core_.make_request(now_s, options_.scene.size), now_s);
    take_deliveries(now_s);  // with no latency the answer to this very frame's request is here already

    const std::vector<Eye> eyes = eyes_of(head, core_.rig());
    const FrameDecision decision = core_.decide(now_s, eyes);
    const bool thorough = frame % k_thorough_every == 0;
    const FrameTruth& truth = judge_.look(
        eyes, thorough ? FrameJudge::Thoroughness::everything : FrameJudge::Thoroughness::in_frustum);
    const std::vector<ObjectId>& drawn = draw_list_.visible(eyes, decision);
    if (thorough) measure_layers(eyes, truth.in_frustum, drawn);
    return {path_s, judge_.judge(eyes, drawn), decision.fallback != Fallback::none, decision.last_age_s,
            decision.next_lead_s};
  }

  [[nodiscard]] nlohmann::ordered_json report(const std::vector<FrameRecord>& frames, double wall_s) {
    nlohmann::ordered_json report = report_header(context_->description());
    report["settings"] = settings_of(options_.scene, options_.replay, culling_options_of(options_.service),
                                     options_.service, connection_.session().welcome());
    report["settings"]["latency_ms"] = options_.latency_ms;
    report["settings"]["still"] = options_.still;
    report["quality"] = quality_of(frames, scene_.object_count(), scene_.triangle_count(),
                                   layers_frustum_max_, layers_drawn_max_);
    // All that differs from run to run.
    report["timing"] = {{"wall_s", wall_s},
                        {"answer_ms_mean", 1000.0 * mean_of(answer_s_)},
                        {"answer_ms_p99", 1000.0 * quantile_of(answer_s_, 0.99)},
                        // From the request to the usable set, less the daemon's own work.
                        {"link_overhead_ms_p50", 1000.0 * quantile_of(link_overhead_s_, 0.5)},
                        {"link_overhead_ms_p99", 1000.0 * quantile_of(link_overhead_s_, 0.99)}};
    return report;
  }

 private:
  /// Asks again when the session was lost on the way: a daemon that --connect found may have closed it while
  /// a slow frame was judged.
  Answer ask(const ViewRequest& request) {
    CullingSession& session = connection_.session();
    const auto start = RealClock::now();
    std::optional<Answer> answer;
    while (!answer && seconds_since(start) < k_answer_timeout_s) {
      if (session.wait_until_open(k_answer_timeout_s) != SessionState::open) break;
      session.send(request, clock_s());
      // Comes back early when the daemon says that it knows no such session.
      answer = session.wait_for(request.request_seq, k_answer_timeout_s - seconds_since(start));
    }
    if (!answer) {
      throw MachineError(connection_.endpoint() + ": no answer to request " +
                         std::to_string(request.request_seq) + " within " +
                         std::to_string(static_cast<int>(k_answer_timeout_s)) +
                         " s; is control_view still running?");
    }
    const StageTimes& t = answer->frame.times;
    answer_s_.push_back(seconds_since(start));
    link_overhead_s_.push_back(answer_s_.back() - t.queue_s - t.cull_s - t.draw_s - t.count_s - t.filter_s);
    return *std::move(answer);
  }

  void take_deliveries(double now_s) {
    for (const VirtualDaemon::Delivery& delivery : daemon_.deliver(now_s)) {
      core_.accept(delivery.answer.request, delivery.issued_s, delivery.answer.set, delivery.received_s);
    }
  }

  void measure_layers(std::span<const Eye> eyes, std::span<const ObjectId> in_frustum,
                      std::span<const ObjectId> drawn) {
    for (const Eye& eye : eyes) {
      layers_frustum_max_ = std::max(layers_frustum_max_, layers_.count(gpu_scene_, eye, in_frustum).max);
      layers_drawn_max_ = std::max(layers_drawn_max_, layers_.count(gpu_scene_, eye, drawn).max);
    }
  }

  AuditOptions options_;
  CameraPath path_;
  std::uint32_t frame_count_;
  Scene scene_;
  ServiceConnection connection_;
  std::unique_ptr<gl::Context> context_;
  gl::GpuScene gpu_scene_;
  FrameJudge judge_;
  DepthComplexity layers_;
  DrawListBuilder draw_list_;
  CullingCore core_;
  VirtualDaemon daemon_;
  std::vector<double> answer_s_, link_overhead_s_;
  std::uint32_t layers_frustum_max_ = 0, layers_drawn_max_ = 0;
};

void print_summary(const nlohmann::ordered_json& quality, std::ostream& out) {
  for (const char* field :
       {"frames", "objects", "wrong_pixels_mean", "wrong_pixels_max", "frames_with_wrong_pixels",
        "missed_objects_max", "conservativity_mean", "fallback_frames"}) {
    out << field << ": " << quality[field] << '\n';
  }
}

void write_frames_csv(const std::filesystem::path& file, const std::vector<FrameRecord>& frames) {
  std::ofstream out(file);
  out << "time_s,wrong_pixels,missed_objects,drawn_objects,visible_objects,fallback,last_age_ms,next_lead_"
         "ms\n";
  for (const FrameRecord& frame : frames) {
    const FrameVerdict& v = frame.verdict;
    out << frame.time_s << ',' << v.wrong_pixels << ',' << v.missed_objects << ',' << v.drawn_objects << ','
        << v.visible_objects << ',' << frame.fallback << ',';
    if (frame.last_age_s) out << 1000.0 * *frame.last_age_s;
    out << ',';
    if (frame.next_lead_s) out << 1000.0 * *frame.next_lead_s;
    out << '\n';
  }
  if (!out.flush()) throw InputError(file.string() + ": cannot be written; check the folder and its rights");
}

}  // namespace

ExitCode run_audit(const AuditOptions& options) {
  require_writable(options.json, "--json");
  if (!options.frames_csv.empty()) require_writable(options.frames_csv, "--frames-csv");
  const auto start = RealClock::now();
  Audit audit(options);
  std::vector<FrameRecord> frames;
  Progress progress("audit", audit.frame_count());
  for (std::uint32_t frame = 0; frame < audit.frame_count(); ++frame) {
    frames.push_back(audit.step(frame));
    progress.advance(frame + 1);
  }
  const nlohmann::ordered_json report = audit.report(frames, seconds_since(start));
  write_report(options.json, report);
  if (!options.frames_csv.empty()) write_frames_csv(options.frames_csv, frames);
  print_summary(report["quality"], std::cout);
  const bool short_of_it =
      options.max_wrong_pixels && report["quality"]["wrong_pixels_mean"] > *options.max_wrong_pixels;
  return short_of_it ? ExitCode::fell_short : ExitCode::done;
}

}  // namespace sightline
