// The daemon is killed in mid-run: the picture stays right, and culling comes back when the daemon does.

#include <algorithm>
#include <chrono>

#include <gtest/gtest.h>

#include "common/gl/context.hpp"
#include "common/scene/generate_city.hpp"
#include "common/scene/load_scene.hpp"
#include "main_view/app/draw_list.hpp"
#include "main_view/app/frame_judge.hpp"
#include "main_view/client/culling_session.hpp"
#include "tests/integration/scenario.hpp"

namespace sightline {
namespace {

using namespace testing;

constexpr ImageSize k_size{160, 120};

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// A renderer reduced to what matters here: it asks, decides and is judged, in real time.
class Renderer {
 public:
  Renderer(const Scenario& scenario, const std::string& endpoint)
      : path_(read_camera_path(scenario.path_file())),
        scene_(load_scene(scenario.scene_file(), {.shading = false})),
        context_(gl::make_offscreen_context(gl::ContextKind::osmesa)),
        gpu_scene_(scene_, false),
        judge_(scene_, gpu_scene_, k_size),
        draw_list_(judge_.hierarchy(), scene_.world_origin_m),
        core_({}, {{glm::dmat4(1.0), clip_from_camera(Perspective{}, 4.0 / 3.0)}}),
        session_(session_options(endpoint)) {}

  struct Frame {
    FrameVerdict verdict;
    bool fallback;
  };

  Frame step() {
    const double time_s = now_s();
    for (const Answer& answer : session_.poll(time_s)) {
      core_.accept(answer.request, answer.issued_s, answer.set, now_s());
    }
    if (session_.lost_count() != lost_seen_) {
      lost_seen_ = session_.lost_count();
      core_.forget_sets();
    }
    const Pose head = path_.at(0.05 * (time_s - start_s_));  // a slow walk: the culling is not on trial here
    core_.add_pose({time_s, head});
    session_.send(core_.make_request(time_s, k_size), time_s);
    const std::vector<Eye> eyes = eyes_of(head, core_.rig());
    const FrameDecision decision = core_.decide(time_s, eyes);
    judge_.look(eyes);
    return {judge_.judge(eyes, draw_list_.visible(eyes, decision)), decision.fallback != Fallback::none};
  }

  /// Steps until a frame is (or is not) a fallback; false when that takes too long.
  bool step_until(bool fallback, double timeout_s) {
    const double deadline_s = now_s() + timeout_s;
    while (now_s() < deadline_s) {
      if (judged_step() == fallback) return true;
    }
    return false;
  }

  /// One frame, added to the sums below; whether it was a fallback.
  bool judged_step() {
    const Frame frame = step();
    (frame.fallback ? wrong_in_fallback_ : wrong_in_service_) += frame.verdict.wrong_pixels;
    if (!frame.fallback) service_pixels_ += frame.verdict.pixels;
    return frame.fallback;
  }

  [[nodiscard]] std::uint64_t wrong_in_fallback() const { return wrong_in_fallback_; }
  /// Share of the pixels of all frames drawn with the service's sets.
  [[nodiscard]] double wrong_share_in_service() const {
    return double(wrong_in_service_) / double(std::max<std::uint64_t>(service_pixels_, 1));
  }

 private:
  [[nodiscard]] SessionOptions session_options(const std::string& endpoint) const {
    SessionOptions options;
    options.endpoint = endpoint;
    options.scene_digest = scene_.digest;
    options.object_count = scene_.object_count();
    return options;
  }

  CameraPath path_;
  Scene scene_;
  std::unique_ptr<gl::Context> context_;
  gl::GpuScene gpu_scene_;
  FrameJudge judge_;
  DrawListBuilder draw_list_;
  CullingCore core_;
  CullingSession session_;
  std::uint64_t lost_seen_ = 0;
  double start_s_ = now_s();
  std::uint64_t wrong_in_fallback_ = 0, wrong_in_service_ = 0, service_pixels_ = 0;
};

TEST(DaemonLoss, NeitherSpoilsThePictureNorLasts) {
  const Scenario city = small_city();
  const std::vector<std::string> arguments = {"--scene", city.scene_file(), "--size", "320x240"};
  auto daemon = std::make_unique<Daemon>(arguments);
  const std::string endpoint = daemon->endpoint();
  Renderer renderer(city, endpoint);
  ASSERT_TRUE(renderer.step_until(false, 30.0)) << "culling never began";
  for (int i = 0; i < 20; ++i) renderer.judged_step();

  daemon->kill_now();
  ASSERT_TRUE(renderer.step_until(true, 10.0)) << "still culling with a dead daemon's sets";
  for (int i = 0; i < 20; ++i) renderer.judged_step();

  daemon = std::make_unique<Daemon>(arguments, endpoint);
  EXPECT_TRUE(renderer.step_until(false, 30.0)) << "culling did not come back";
  EXPECT_EQ(renderer.wrong_in_fallback(), 0u);
  // The last sets serve on for a moment; what that costs is what prediction costs anyway.
  EXPECT_LE(renderer.wrong_share_in_service(), 1e-3);
}

}  // namespace
}  // namespace sightline
