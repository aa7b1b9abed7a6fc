#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common/object_hierarchy.hpp"
#include "common/scene/scene.hpp"
#include "common/view.hpp"
#include "main_view/app/draw_list.hpp"
#include "main_view/app/virtual_daemon.hpp"
#include "main_view/client/culling_core.hpp"
#include "tests/quality/in_process_session.hpp"

namespace sightline::testing {

/// How a scene is served and looked at. The images are half as wide and high as those of the audit and in the
/// same ratio, so that a flight of two seconds takes a fraction of one.
struct ServiceSetup {
  CullingOptions culling;
  PipelineOptions pipeline;
  ImageSize main_size{512, 384};
  Perspective perspective;
  double frame_rate_hz = 60.0;
  double control_rate_hz = 30.0;
  double latency_s = 0.05;
  double eye_separation_m = 0.0;  ///< 0: a single eye
};

/// What a user gets who chooses nothing.
[[nodiscard]] ServiceSetup default_setup(double latency_s);
/// The paper's pipeline: order 2 over 20 poses, no guard band, mean over 8 answers.
[[nodiscard]] ServiceSetup avango_setup(double latency_s);

/// Where the camera is at a time, seconds from 0.
using Motion = std::function<Pose(double time_s)>;

/// One frame against the truth. Opaque objects that were left out leave exactly their visible pixels wrong;
/// a blended one counts every pixel where it has a fragment in front of the opaque surfaces.
struct FrameOutcome {
  double time_s = 0.0;
  std::uint64_t wrong_pixels = 0;
  std::map<ObjectId, std::uint32_t> missed;  ///< visible, not drawn, with their pixels
  std::uint32_t drawn_objects = 0;
  std::uint32_t visible_objects = 0;
  std::uint32_t in_frustum_objects = 0;
  Fallback fallback = Fallback::none;
};

/// How often an object came and went while it stayed in the view frustum.
struct StateChanges {
  std::uint32_t drawn = 0;
  std::uint32_t truly = 0;
};

/// A whole flight.
struct FlightOutcome {
  std::vector<FrameOutcome> frames;
  std::map<ObjectId, StateChanges> changes;

  [[nodiscard]] std::uint32_t wrong_frames() const;
  [[nodiscard]] std::uint64_t wrong_pixels() const;
  /// Mean of drawn / visible objects from the first answer on, over the frames that show anything.
  [[nodiscard]] double conservativity() const;
  /// The same for what view-frustum culling alone would draw: what there is to be won.
  [[nodiscard]] double conservativity_of_the_frustum() const;
  /// Frames drawn with view-frustum culling alone, from the first answer on.
  [[nodiscard]] std::uint32_t fallbacks_after_first_answer() const;
  /// Objects that changed more often than the truth by more than coming and going once.
  [[nodiscard]] std::uint32_t restless_objects() const;
  /// One line with all of the above.
  [[nodiscard]] std::string summary() const;
};

/// The whole service in one process on a virtual clock: the client's core, the daemon's session with the
/// `raster` engine, sets encoded and decoded between them, requests at the control rate, answers `latency_s`
/// later. No socket and no OpenGL. The judge is a second raster engine at the main image's size: its counts
/// are those of OpenGL's item buffer.
class VirtualService {
 public:
  /// `scene` must outlive this.
  VirtualService(const Scene& scene, const ServiceSetup& setup);

  /// The next frame, with the camera at `head`.
  FrameOutcome step(const Pose& head);

  // Of the last step.
  [[nodiscard]] const std::vector<Eye>& eyes() const noexcept { return eyes_; }
  [[nodiscard]] const std::vector<ObjectId>& drawn() const noexcept { return drawn_; }
  [[nodiscard]] const std::vector<ObjectId>& in_frustum() const noexcept { return in_frustum_; }
  [[nodiscard]] const PixelCounts& truth() const noexcept { return truth_; }

 private:
  const Scene& scene_;
  ServiceSetup setup_;
  std::unique_ptr<VisibilityEngine> judge_;
  InProcessSession session_;
  ObjectHierarchy hierarchy_;
  DrawListBuilder draw_list_;
  CullingCore core_;
  VirtualDaemon daemon_;
  std::uint32_t frame_ = 0;
  std::vector<Eye> eyes_;
  std::vector<ObjectId> drawn_, in_frustum_;
  PixelCounts truth_;
};

/// Flies `motion` for `duration_s` through a service of its own.
[[nodiscard]] FlightOutcome fly(const Scene& scene, const Motion& motion, double duration_s,
                                const ServiceSetup& setup);

// Verdicts, for EXPECT_TRUE. What they say on failure names the first frames and objects that are wrong.
[[nodiscard]] ::testing::AssertionResult has_at_most_wrong_frames(std::uint32_t frames,
                                                                  const FlightOutcome& outcome);
[[nodiscard]] ::testing::AssertionResult falls_back_at_most(std::uint32_t frames,
                                                            const FlightOutcome& outcome);
[[nodiscard]] ::testing::AssertionResult keeps_at_most(double conservativity, const FlightOutcome& outcome);
[[nodiscard]] ::testing::AssertionResult has_at_most_restless_objects(std::uint32_t objects,
                                                                      const FlightOutcome& outcome);

}  // namespace sightline::testing
