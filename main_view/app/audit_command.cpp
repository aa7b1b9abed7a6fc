#include "main_view/app/audit_command.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>
#include <iterator>

#include <nlohmann/json.hpp>

#include "common/camera_path.hpp"
#include "common/scene/load_scene.hpp"
#include "common/statistics.hpp"
#include "main_view/app/depth_complexity.hpp"
#include "main_view/app/draw_list.hpp"
#include "main_view/app/find_truth.hpp"
#include "main_view/app/frame_judge.hpp"
#include "main_view/app/progress.hpp"
#include "main_view/app/quality.hpp"
#include "main_view/app/report.hpp"
#include "main_view/app/service_connection.hpp"
#include "main_view/app/truth_cache.hpp"
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

/// Objects that are in one of two frames' ascending lists alone.
std::uint32_t changes_between(std::span<const ObjectId> before, std::span<const ObjectId> now) {
  std::vector<ObjectId> changed;
  std::set_symmetric_difference(before.begin(), before.end(), now.begin(), now.end(),
                                std::back_inserter(changed));
  return static_cast<std::uint32_t>(changed.size());
}

/// Everything the replay holds; made once, stepped frame by frame.
class Audit {
 public:
  explicit Audit(const AuditOptions& options)
      : options_(options),
        path_(read_camera_path(options.scene.path)),
        head_motion_(options.head),
        frame_count_(options.replay.frame_count(path_.duration_s())),
        lead_frames_(std::llround(options.lead_in_s * options.replay.rate_hz)),
        scene_(load_scene(options.scene.scene, {.shading = false})),
        connection_(options.scene.scene, scene_, options.service.on_virtual_clock()),
        context_(gl::make_offscreen_context(options.scene.context)),
        gpu_scene_(scene_, false),
        judge_(scene_, gpu_scene_, options.scene.size),
        known_truth_(options.truth,
                     {scene_.digest, scene_.object_count(), options.scene.size, context_->description()}),
        layers_(options.scene.size),
        draw_list_(judge_.hierarchy(), scene_.world_origin_m),
        core_(culling_options_of(options.service), rig_of(options.scene, options.replay)),
        daemon_([this](const ViewRequest& request) { return ask(request); }, options.service.control_rate_hz,
                options.latency_ms / 1000.0) {
    connection_.require_open(k_answer_timeout_s);
  }

  [[nodiscard]] std::uint32_t frame_count() const noexcept { return frame_count_; }

  /// What comes before the first frame: seen by the service, judged by nobody.
  void lead_in() {
    for (std::int64_t frame = -lead_frames_; frame < 0; ++frame) (void)move_on(frame);
  }

  /// One frame: camera -> request -> (daemon, virtual latency) -> sets -> decision -> draw list -> verdict.
  FrameRecord step(std::uint32_t frame) {
    const std::vector<Eye> eyes = move_on(frame);
    const double path_s = path_seconds(frame);
    const double now_s = virtual_seconds(frame);
    const FrameDecision decision = core_.decide(now_s, eyes);
    const bool thorough = frame % k_thorough_every == 0;
    const FrameTruth& truth = find_truth(judge_, known_truth_, eyes, thorough);
    const std::vector<ObjectId>& drawn = draw_list_.visible(eyes, decision);
    if (thorough) measure_layers(eyes, truth.in_frustum, drawn);
    FrameRecord record{path_s, judge_.judge(eyes, drawn), decision.fallback != Fallback::none,
                       decision.last_age_s, decision.next_lead_s};
    if (frame > 0) {
      record.drawn_changes = changes_between(drawn_before_, drawn);
      record.true_changes = changes_between(visible_before_, truth.visible);
    }
    drawn_before_ = drawn;
    visible_before_ = truth.visible;
    return record;
  }

  void save_truth() { known_truth_.save(); }

  [[nodiscard]] nlohmann::ordered_json report(const std::vector<FrameRecord>& frames, double wall_s) {
    nlohmann::ordered_json report = report_header(context_->description());
    report["settings"] = settings_of(options_.scene, options_.replay, culling_options_of(options_.service),
                                     options_.service, connection_.session().welcome());
    report["settings"]["latency_ms"] = options_.latency_ms;
    report["settings"]["lead_in_s"] = options_.lead_in_s;
    report["settings"]["still"] = options_.still;
    report["settings"]["rotations"] = options_.head.rotations.filename().string();
    report["settings"]["turn_deg_per_s"] = options_.head.turn_deg_per_s;
    if (std::isinf(options_.head.turn_deg_per_s))
      report["settings"]["turn_deg_per_s"] = "inf";  // JSON has none
    report["quality"] = quality_of(frames, scene_.object_count(), scene_.triangle_count(),
                                   layers_frustum_max_, layers_drawn_max_);
    // All that differs from run to run.
    report["timing"] = {{"wall_s", wall_s},
                        {"answer_ms_mean", 1000.0 * mean_of(answer_s_)},
                        {"answer_ms_p99", 1000.0 * quantile_of(answer_s_, 0.99)},
                        // The daemon's own stages: cull, draw, count and filter.
                        {"control_ms_mean", 1000.0 * mean_of(control_s_)},
                        {"control_ms_p50", 1000.0 * quantile_of(control_s_, 0.5)},
                        {"control_ms_p99", 1000.0 * quantile_of(control_s_, 0.99)},
                        {"request_bytes_mean", mean_of(request_bytes_)},
                        {"answer_bytes_mean", mean_of(answer_bytes_)},
                        // From the request to the usable set, less the daemon's own work.
                        {"link_overhead_ms_p50", 1000.0 * quantile_of(link_overhead_s_, 0.5)},
                        {"link_overhead_ms_p99", 1000.0 * quantile_of(link_overhead_s_, 0.99)}};
    return report;
  }

 private:
  [[nodiscard]] double virtual_seconds(std::int64_t frame) const {
    return static_cast<double>(frame + lead_frames_) / options_.replay.rate_hz;
  }
  [[nodiscard]] double path_seconds(std::int64_t frame) const {
    if (options_.still) return options_.replay.start_s;
    // The very same moments, to the bit, wherever a run starts: known truth is found again by them.
    const double first = options_.replay.start_s * options_.replay.rate_hz;
    return std::max((first + static_cast<double>(frame)) / options_.replay.rate_hz, 0.0);
  }

  /// Moves the camera to `frame`, negative in the lead-in, and asks the service; gives the eyes of that
  /// moment.
  std::vector<Eye> move_on(std::int64_t frame) {
    const double now_s = virtual_seconds(frame);
    const double run_s = std::max(static_cast<double>(frame), 0.0) / options_.replay.rate_hz;
    const Pose head = head_motion_.applied_to(path_.at(path_seconds(frame)), run_s);
    take_deliveries(now_s);
    core_.add_pose({now_s, head});
    daemon_.issue(core_.make_request(now_s, options_.scene.size), now_s);
    take_deliveries(now_s);  // with no latency the answer to this very frame's request is here already
    return eyes_of(head, core_.rig());
  }

  /// Asks again when the session was lost on the way: a daemon that --connect found may have closed it while
  /// a slow frame was judged.
  Answer ask(const ViewRequest& request) {
    CullingSession& session = connection_.session();
    const auto start = RealClock::now();
    const std::uint64_t sent_before = session.bytes_sent();
    const std::uint64_t received_before = session.bytes_received();
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
    control_s_.push_back(t.cull_s + t.draw_s + t.count_s + t.filter_s);
    link_overhead_s_.push_back(answer_s_.back() - t.queue_s - control_s_.back());
    request_bytes_.push_back(static_cast<double>(session.bytes_sent() - sent_before));
    answer_bytes_.push_back(static_cast<double>(session.bytes_received() - received_before));
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
  HeadMotion head_motion_;
  std::uint32_t frame_count_;
  std::int64_t lead_frames_;
  Scene scene_;
  ServiceConnection connection_;
  std::unique_ptr<gl::Context> context_;
  gl::GpuScene gpu_scene_;
  FrameJudge judge_;
  TruthCache known_truth_;
  DepthComplexity layers_;
  DrawListBuilder draw_list_;
  CullingCore core_;
  VirtualDaemon daemon_;
  std::vector<ObjectId> drawn_before_, visible_before_;
  std::vector<double> answer_s_, control_s_, link_overhead_s_, request_bytes_, answer_bytes_;
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
  if (!options.truth.empty()) require_writable(options.truth, "--truth");
  const auto start = RealClock::now();
  Audit audit(options);
  std::vector<FrameRecord> frames;
  audit.lead_in();
  Progress progress("audit", audit.frame_count());
  for (std::uint32_t frame = 0; frame < audit.frame_count(); ++frame) {
    frames.push_back(audit.step(frame));
    progress.advance(frame + 1);
  }
  audit.save_truth();
  const nlohmann::ordered_json report = audit.report(frames, seconds_since(start));
  write_report(options.json, report);
  if (!options.frames_csv.empty()) write_frames_csv(options.frames_csv, frames);
  print_summary(report["quality"], std::cout);
  const bool short_of_it =
      options.max_wrong_pixels && report["quality"]["wrong_pixels_mean"] > *options.max_wrong_pixels;
  return short_of_it ? ExitCode::fell_short : ExitCode::done;
}

}  // namespace sightline
