#include "main_view/app/judge_command.hpp"

#include <algorithm>
#include <iostream>
#include <iterator>

#include <nlohmann/json.hpp>

#include "common/camera_path.hpp"
#include "common/scene/load_scene.hpp"
#include "main_view/app/find_truth.hpp"
#include "main_view/app/frame_judge.hpp"
#include "main_view/app/progress.hpp"
#include "main_view/app/quality.hpp"
#include "main_view/app/report.hpp"
#include "main_view/app/service_connection.hpp"
#include "main_view/app/sets_file.hpp"
#include "main_view/app/truth_cache.hpp"

namespace sightline {
namespace {

// As in the audit: every so many judged frames the truth is drawn from really every object.
constexpr std::size_t k_thorough_every = 30;

class SetsJudge {
 public:
  explicit SetsJudge(const JudgeOptions& options)
      : options_(options),
        path_(read_camera_path(options.scene.path)),
        scene_(load_scene(options.scene.scene, {.shading = false})),
        sets_(read_frame_sets(options.sets, options.replay.frame_count(path_.duration_s()),
                              scene_.object_count())),
        rig_(rig_of(options.scene, options.replay)),
        context_(gl::make_offscreen_context(options.scene.context)),
        gpu_scene_(scene_, false),
        judge_(scene_, gpu_scene_, options.scene.size),
        known_truth_(options.truth,
                     {scene_.digest, scene_.object_count(), options.scene.size, context_->description()}) {}

  [[nodiscard]] std::size_t count() const noexcept { return sets_.size(); }

  FrameRecord step(std::size_t index) {
    const FrameSet& set = sets_[index];
    // The very same moments as in an audit, to the bit: known truth is found again by them.
    const double rate_hz = options_.replay.rate_hz;
    const double path_s = (options_.replay.start_s * rate_hz + set.frame) / rate_hz;
    const std::vector<Eye> eyes = eyes_of(path_.at(path_s), rig_);
    const FrameTruth& truth = find_truth(judge_, known_truth_, eyes, index % k_thorough_every == 0);
    // Every client has a view frustum of its own: what lies outside is in no image.
    std::vector<ObjectId> drawn = truth.in_frustum;
    if (!set.everything) {
      drawn.clear();
      std::set_intersection(set.ids.begin(), set.ids.end(), truth.in_frustum.begin(), truth.in_frustum.end(),
                            std::back_inserter(drawn));
    }
    FrameRecord record;
    record.time_s = path_s;
    record.verdict = judge_.judge(eyes, drawn);
    record.fallback = set.everything;
    return record;
  }

  void save_truth() { known_truth_.save(); }

  [[nodiscard]] nlohmann::ordered_json report(const std::vector<FrameRecord>& frames) const {
    nlohmann::ordered_json report = report_header(context_->description());
    report["settings"] = {{"scene", options_.scene.scene.filename().string()},
                          {"path", options_.scene.path.filename().string()},
                          {"sets", options_.sets.filename().string()},
                          {"size", {options_.scene.size.width, options_.scene.size.height}},
                          {"vertical_fov_deg", options_.scene.vertical_fov_deg},
                          {"near_m", options_.scene.near_m},
                          {"far_m", options_.scene.far_m},
                          {"rate_hz", options_.replay.rate_hz},
                          {"start_s", options_.replay.start_s},
                          {"stereo", options_.replay.stereo}};
    nlohmann::ordered_json quality = quality_of(frames, scene_.object_count(), scene_.triangle_count(), 0, 0);
    // Frames need not follow each other here, and layers are not counted.
    for (const char* field : {"state_changes_drawn_mean", "state_changes_true_mean",
                              "depth_complexity_frustum_max", "depth_complexity_drawn_max"}) {
      quality.erase(field);
    }
    report["quality"] = quality;
    return report;
  }

 private:
  JudgeOptions options_;
  CameraPath path_;
  Scene scene_;
  std::vector<FrameSet> sets_;
  std::vector<RigEye> rig_;
  std::unique_ptr<gl::Context> context_;
  gl::GpuScene gpu_scene_;
  FrameJudge judge_;
  TruthCache known_truth_;
};

}  // namespace

ExitCode run_judge(const JudgeOptions& options) {
  require_writable(options.json, "--json");
  if (!options.truth.empty()) require_writable(options.truth, "--truth");
  SetsJudge judge(options);
  std::vector<FrameRecord> frames;
  Progress progress("judge", judge.count());
  for (std::size_t i = 0; i < judge.count(); ++i) {
    frames.push_back(judge.step(i));
    progress.advance(i + 1);
  }
  judge.save_truth();
  const nlohmann::ordered_json report = judge.report(frames);
  write_report(options.json, report);
  const nlohmann::ordered_json& quality = report["quality"];
  for (const char* field : {"frames", "objects", "wrong_pixels_mean", "wrong_pixels_max",
                            "frames_with_wrong_pixels", "missed_objects_max", "conservativity_mean",
                            "fallback_frames", "triangles_frustum", "triangles_drawn", "triangles_oracle"}) {
    std::cout << field << ": " << quality[field] << '\n';
  }
  const bool short_of_it =
      options.max_wrong_pixels && quality["wrong_pixels_mean"] > *options.max_wrong_pixels;
  return short_of_it ? ExitCode::fell_short : ExitCode::done;
}

}  // namespace sightline
