// That the judge of the flights, a raster engine's counts, says what the pictures of OpenGL say.

#include "common/gl/context.hpp"
#include "main_view/app/frame_judge.hpp"
#include "tests/quality/motions.hpp"
#include "tests/quality/quality_scenes.hpp"

namespace sightline::testing {
namespace {

/// Every few frames of a flight, both judges on what was drawn. Returns the wrong pixels both found.
std::uint64_t compare_judges(const Scene& scene, const Motion& motion, const ServiceSetup& setup,
                             bool blended) {
  constexpr int k_frames = 120, k_step = 8;
  const auto context = gl::make_offscreen_context(gl::ContextKind::osmesa);
  gl::GpuScene gpu_scene(scene, false);
  FrameJudge judge(scene, gpu_scene, setup.main_size);
  VirtualService service(scene, setup);
  std::uint64_t wrong_pixels = 0;
  for (int frame = 0; frame < k_frames; ++frame) {
    const FrameOutcome outcome = service.step(motion(frame / setup.frame_rate_hz));
    if (frame % k_step != 0) continue;
    const FrameTruth& truth = judge.look(service.eyes(), FrameJudge::Thoroughness::everything);
    EXPECT_EQ(truth.visible, service.truth().ids) << "frame " << frame;
    const FrameVerdict verdict = judge.judge(service.eyes(), service.drawn());
    EXPECT_EQ(verdict.missed_objects, outcome.missed.size()) << "frame " << frame;
    EXPECT_EQ(verdict.drawn_objects, outcome.drawn_objects) << "frame " << frame;
    // Where panes overlap one pixel is wrong once and counts for each.
    if (blended) {
      EXPECT_LE(verdict.wrong_pixels, outcome.wrong_pixels) << "frame " << frame;
    } else {
      EXPECT_EQ(verdict.wrong_pixels, outcome.wrong_pixels) << "frame " << frame;
    }
    wrong_pixels += verdict.wrong_pixels;
  }
  return wrong_pixels;
}

TEST(FlightJudge, FindsThePixelsWrongThatOpenGlFindsWrongAtADoor) {
  const auto motion = with_head(walk({-1.0, 1.7, 3.0}, {0.3, 1.7, -2.0}, 4.0));
  EXPECT_GT(compare_judges(door_scene(), motion, avango_setup(0.1), false), 0u);
}

TEST(FlightJudge, FindsThePixelsWrongThatOpenGlFindsWrongAtAFence) {
  const auto motion = with_head(walk({-6.0, 1.7, 4.0}, {6.0, 1.7, 4.0}, 6.0, -20.0));
  EXPECT_GT(compare_judges(fence_scene(), motion, avango_setup(0.1), false), 0u);
}

TEST(FlightJudge, AgreesWithOpenGlOnWhatGlassShows) {
  (void)compare_judges(glass_door_scene(), with_head(walk({-1.0, 1.7, 3.0}, {0.3, 1.7, -2.0}, 4.0)),
                       avango_setup(0.1), true);
}

TEST(FlightJudge, FindsThePixelsWrongThatOpenGlFindsWrongOfFarPoles) {
  EXPECT_GT(
      compare_judges(needle_scene(), walk({-1.0, 1.7, 4.0}, {1.0, 1.7, 0.0}, 2.0), avango_setup(0.1), false),
      0u);
}

}  // namespace
}  // namespace sightline::testing
