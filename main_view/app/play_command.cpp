#include "main_view/app/play_command.hpp"

#include <algorithm>
#include <chrono>
#include <iomanip>
#include <iostream>
#include <optional>
#include <thread>

#include <GLFW/glfw3.h>
#include <nlohmann/json.hpp>

#include "common/camera_path.hpp"
#include "common/scene/load_scene.hpp"
#include "main_view/app/draw_list.hpp"
#include "main_view/app/frame_judge.hpp"
#include "main_view/app/image_set.hpp"
#include "main_view/app/play_report.hpp"
#include "main_view/app/plot.hpp"
#include "main_view/app/png.hpp"
#include "main_view/app/progress.hpp"
#include "main_view/app/renderer.hpp"
#include "main_view/app/report.hpp"
#include "main_view/app/service_connection.hpp"

namespace sightline {
namespace {

constexpr std::uint32_t k_block_frames = 120;  // of one culling before the next takes its turn
constexpr std::uint32_t k_warm_up_frames =
    20;  // before each block: caches, the session's sets, the predictor
constexpr double k_open_timeout_s = 30.0;

using RealClock = std::chrono::steady_clock;

double now_s() {
  return std::chrono::duration<double>(RealClock::now().time_since_epoch()).count();
}

/// The replay of one path under several cullings.
class Player {
 public:
  /// `path` and `scene` are read before anything is opened: bad input is the first thing a user hears of.
  Player(const PlayOptions& options, CameraPath path, Scene scene)
      : options_(options),
        path_(std::move(path)),
        frame_count_(options.replay.frame_count(path_.duration_s())),
        context_(options.headless ? gl::make_offscreen_context(options.scene.context)
                                  : gl::make_window(options.scene.size, "Sightline play")),
        scene_(std::move(scene)),
        connection_(uses(CullingMode::service) ? std::make_unique<ServiceConnection>(
                                                     options.scene.scene, scene_.scene(), options.service)
                                               : nullptr),
        judge_(scene_.scene(), scene_.gpu(), options.scene.size),
        target_(options.scene.size),
        draw_list_(scene_.hierarchy(), scene_.scene().world_origin_m),
        core_(culling_options_of(options.service), rig_of(options.scene, options.replay)) {
    runs_.push_back({options.culling, {}});
    for (const CullingMode mode : options.compare) {
      const bool named =
          std::any_of(runs_.begin(), runs_.end(), [&](const PlayRun& run) { return run.mode == mode; });
      if (!named) runs_.push_back({mode, {}});
    }
    if (connection_) connection_->require_open(k_open_timeout_s);
  }

  void play() {
    Progress progress("play", std::uint64_t{frame_count_} * runs_.size());
    std::uint64_t done = 0;
    for (std::uint32_t first = 0; first < frame_count_ && !closed_; first += k_block_frames) {
      const std::uint32_t end = std::min(first + k_block_frames, frame_count_);
      for (PlayRun& run : runs_) {
        play_block(run, first, end);
        progress.advance(done += end - first);
      }
    }
  }

  [[nodiscard]] nlohmann::ordered_json report() {
    nlohmann::ordered_json report = report_header(context_->description());
    report["settings"] =
        settings_of(options_.scene, options_.replay, culling_options_of(options_.service), options_.service,
                    connection_ ? connection_->session().welcome() : std::nullopt);
    report["settings"]["flat_out"] = options_.flat_out;
    report["scene"] = {{"objects", scene_.scene().object_count()},
                       {"triangles", scene_.scene().triangle_count()}};
    if (connection_) {
      service_.bytes_sent = connection_->session().bytes_sent();
      service_.bytes_received = connection_->session().bytes_received();
      service_.bad_frames = connection_->session().bad_frame_count();
      service_.sessions_lost = connection_->session().lost_count();
    }
    report["timing"] = timing_of(runs_, service_);
    return report;
  }

  /// Pictures of one moment of the path, drawn with what the first culling keeps there; with --stereo of the
  /// left eye.
  ImageSetResult write_images(const std::filesystem::path& folder) {
    const double path_s = options_.image_at_s.value_or(options_.replay.start_s +
                                                       0.5 * (frame_count_ - 1) / options_.replay.rate_hz);
    const auto frame = static_cast<std::uint32_t>(
        std::max(0.0, (path_s - options_.replay.start_s) * options_.replay.rate_hz));
    // Approach the moment as the run did, so that the sets in force are those of a moving camera.
    for (std::uint32_t i = frame - std::min(frame, k_warm_up_frames); i < frame; ++i) {
      draw_frame(options_.culling, i, now_s());
    }
    draw_frame(options_.culling, frame, now_s());
    const std::vector<ObjectId> drawn = last_drawn_;
    const Eye eye = eyes_at(frame).front();
    return write_image_set(folder, scene_, eye, options_.scene.size, drawn);
  }

  [[nodiscard]] const std::vector<PlayRun>& runs() const noexcept { return runs_; }
  [[nodiscard]] double path_seconds(std::uint32_t frame) const noexcept {
    return options_.replay.start_s + frame / options_.replay.rate_hz;
  }

 private:
  [[nodiscard]] bool uses(CullingMode mode) const {
    return options_.culling == mode ||
           std::find(options_.compare.begin(), options_.compare.end(), mode) != options_.compare.end();
  }

  /// Frames [first, end), after a warm-up that leads up to them (before the path's start the camera waits).
  void play_block(PlayRun& run, std::uint32_t first, std::uint32_t end) {
    const double block_start_s = now_s();
    for (std::uint32_t step = 0; step < k_warm_up_frames + end - first && !closed_; ++step) {
      const std::uint32_t frame = std::max(first + step, k_warm_up_frames) - k_warm_up_frames;
      if (!options_.flat_out) wait_until(block_start_s + step / options_.replay.rate_hz);
      // Also while another culling plays: a session must be heard to stay open, and an answer be timed when
      // it comes.
      if (connection_) take_answers();
      const FrameTiming timing = draw_frame(run.mode, frame, now_s());
      if (step >= k_warm_up_frames) run.frames.push_back(timing);
      show();
    }
    if (run.mode == CullingMode::service) service_.open_s += now_s() - block_start_s;
  }

  /// Sleeps to the frame's time, but hears what the daemon says meanwhile.
  void wait_until(double time_s) {
    while (now_s() < time_s) {
      if (connection_) take_answers();
      const double left_s = std::min(time_s - now_s(), 0.001);
      if (left_s > 0.0) std::this_thread::sleep_for(std::chrono::duration<double>(left_s));
    }
  }

  [[nodiscard]] std::vector<Eye> eyes_at(std::uint32_t frame) const {
    return eyes_of(path_.at(path_seconds(frame)), core_.rig());
  }

  /// One frame: camera -> request -> sets -> decision -> draw list -> image. What is timed is what a renderer
  /// with this culling would do; the oracle's own search for the truth is not.
  FrameTiming draw_frame(CullingMode mode, std::uint32_t frame, double start_s) {
    const std::vector<Eye> eyes = eyes_at(frame);
    FrameTiming timing;
    timing.frame = frame;
    if (mode == CullingMode::oracle) {
      last_drawn_ = judge_.look(eyes).visible;
      start_s = now_s();
    } else if (mode == CullingMode::service) {
      timing.fallback = choose_with_service(eyes, path_.at(path_seconds(frame)), start_s);
    } else if (mode == CullingMode::frustum) {
      last_drawn_ = draw_list_.in_frustum(eyes);
    } else {
      last_drawn_ = scene_.all_ids();
    }
    for (const Eye& eye : eyes) {
      const gl::DrawStats drawn = scene_.renderer().draw(target_, eye, last_drawn_);
      timing.drawn_objects += drawn.objects;
      timing.drawn_triangles += drawn.triangles;
    }
    gl::glFinish();
    timing.frame_s = now_s() - start_s;
    return timing;
  }

  /// Fills last_drawn_; whether it had to fall back.
  bool choose_with_service(std::span<const Eye> eyes, const Pose& head, double time_s) {
    take_answers();
    core_.add_pose({time_s, head});
    connection_->session().send(core_.make_request(time_s, options_.scene.size), time_s);
    const FrameDecision decision = core_.decide(time_s, eyes);
    last_drawn_ = draw_list_.visible(eyes, decision);
    return decision.fallback != Fallback::none;
  }

  void take_answers() {
    CullingSession& session = connection_->session();
    for (const Answer& answer : session.poll(now_s())) {
      const double received_s = now_s();
      core_.accept(answer.request, answer.issued_s, answer.set, received_s);
      const StageTimes& t = answer.frame.times;
      const double round_trip_s = received_s - answer.issued_s;
      service_.round_trip_s.push_back(round_trip_s);
      service_.stages.push_back(t);
      service_.link_overhead_s.push_back(round_trip_s - t.queue_s - t.cull_s - t.draw_s - t.count_s -
                                         t.filter_s);
    }
    if (session.lost_count() != lost_seen_) {
      lost_seen_ = session.lost_count();
      core_.forget_sets();
    }
  }

  void show() {
    GLFWwindow* window = context_->window();
    if (window == nullptr) return;
    target_.show(options_.scene.size);
    glfwSwapBuffers(window);
    glfwPollEvents();
    closed_ = glfwWindowShouldClose(window) == GLFW_TRUE;
  }

  PlayOptions options_;
  CameraPath path_;
  std::uint32_t frame_count_;
  std::unique_ptr<gl::Context> context_;
  DrawableScene scene_;
  std::unique_ptr<ServiceConnection> connection_;
  FrameJudge judge_;
  RenderTarget target_;
  DrawListBuilder draw_list_;
  CullingCore core_;
  std::vector<PlayRun> runs_;
  ServiceTiming service_;
  std::vector<ObjectId> last_drawn_;
  std::uint64_t lost_seen_ = 0;
  bool closed_ = false;
};

void write_plot(const std::filesystem::path& file, const Player& player) {
  std::vector<PlotSeries> series;
  for (const PlayRun& run : player.runs()) {
    PlotSeries line{to_string(run.mode), {}};
    for (const FrameTiming& frame : run.frames) {
      line.points.emplace_back(player.path_seconds(frame.frame), 1000.0 * frame.frame_s);
    }
    series.push_back(std::move(line));
  }
  PlotOptions options;
  options.title = "Frame time along the path";
  options.x_label = "path time, s";
  options.y_label = "frame time, ms";
  write_png(file, plot(series, options));
}

void print_summary(const nlohmann::ordered_json& report, std::ostream& out) {
  out << std::fixed << std::setprecision(1);
  for (const auto& run : report["timing"]["runs"]) {
    out << std::left << std::setw(8) << run["culling"].get<std::string>() << std::right << std::setw(8)
        << run["frame_ms"]["mean"].get<double>() << " ms a frame, " << std::setw(9)
        << run["drawn_triangles"].get<double>() << " triangles, " << std::setw(7)
        << run["drawn_objects"].get<double>() << " objects\n";
  }
  if (report["timing"].contains("share_of_oracle_gain")) {
    out << "the service saves " << 100.0 * report["timing"]["share_of_oracle_gain"].get<double>()
        << " % of what knowing the exact visible set would save\n";
  }
  if (report.contains("images")) {
    out << "images differ in " << report["images"]["wrong_pixels"] << " pixels\n";
  }
}

}  // namespace

ExitCode run_play(const PlayOptions& options) {
  if (!options.json.empty()) require_writable(options.json, "--json");
  if (!options.out.empty()) require_writable(options.out / "report.json", "--out");
  Player player(options, read_camera_path(options.scene.path), load_scene(options.scene.scene));
  player.play();
  nlohmann::ordered_json report = player.report();
  if (!options.out.empty()) {
    const ImageSetResult images = player.write_images(options.out);
    report["images"] = {{"eye", options.replay.stereo ? "left" : "only"},
                        {"wrong_pixels", images.wrong_pixels},
                        {"depth_complexity_frustum_max", images.depth_complexity_frustum_max},
                        {"depth_complexity_drawn_max", images.depth_complexity_drawn_max}};
    write_frames_csv(options.out / "frames.csv", player.runs());
    write_plot(options.out / "frame_time.png", player);
    write_report(options.out / "report.json", report);
  }
  if (!options.json.empty()) write_report(options.json, report);
  print_summary(report, std::cout);
  return ExitCode::done;
}

}  // namespace sightline
