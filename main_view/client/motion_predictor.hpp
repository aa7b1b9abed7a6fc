#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "common/pose.hpp"
#include "main_view/client/adaptive_predictor.hpp"
#include "main_view/client/culling_options.hpp"
#include "main_view/client/polynomial_fit.hpp"
#include "main_view/client/pose_history.hpp"
#include "main_view/client/predicted_pose.hpp"

namespace sightline {

/// Where the camera will be, from where it was: by AdaptivePredictor, or, with PredictorKind::fixed, as
/// follows.
///
/// Klimenko, Nikitina, Nikitin, "Parallel Visibility Test and Occlusion Culling in Avango Virtual Environment
/// Framework": a least-squares polynomial of order n over the last p poses for each of x, y, z and the
/// quaternion's components, which are normalised afterwards. While there are fewer than n + 1 poses the order
/// is lower.
///
/// Ours in addition: the fixed predictor's error estimate. It is the larger of k_fit_error_factor standard
/// deviations of the fit's own prediction, and k_memory_error_factor times the largest error that predictions
/// about as far ahead made in the last k_error_memory_s. Recorded head and hand motion (60 Hz, 5 frames
/// ahead) lies within it 97 times in 100 or more; with no margin on the memory, 91. It errs either way: a
/// sudden turn is in no data before it.
///
/// Cost on one core: see tests/client/bench_predictor.cpp and docs/results.md.
class MotionPredictor {
 public:
  explicit MotionPredictor(const CullingOptions& options);

  /// The pose at `time_s`, in the client's clock. At or before the newest pose's time: that pose exactly,
  /// with no error. A history that stands still predicts itself exactly; the fixed predictor then announces
  /// no error, the adaptive one what its past calls for. Requires a pose in the history. The fixed predictor
  /// remembers the prediction until its time has come.
  [[nodiscard]] PredictedPose predict(const PoseHistory& history, double time_s);

  /// Compares the remembered predictions whose time has come with what happened. Call after each pose.
  void observe(const PoseHistory& history);

  /// Forgets predictions that are under way: after a jump they say nothing.
  void forget_pending() noexcept { pending_.clear(); }

  static constexpr double k_fit_error_factor = 3.0;
  static constexpr double k_memory_error_factor = 1.5;
  static constexpr double k_error_memory_s = 1.0;

 private:
  struct Pending {
    double time_s;
    double lead_s;
    Pose pose;
  };
  struct Outcome {
    double time_s;
    double lead_s;
    double position_error_m;
    double rotation_error_rad;
  };

  [[nodiscard]] PredictedPose predict_fixed(const PoseHistory& history, double time_s);
  [[nodiscard]] PredictedPose extrapolate(const PoseHistory& history, double time_s);

  std::optional<AdaptivePredictor>
      adaptive_;  ///< with PredictorKind::adaptive; what follows is for the other
  int order_;
  int window_;
  std::vector<double> times_s_;         // scratch of extrapolate
  std::vector<PoseComponents> values_;  // likewise
  std::deque<Pending> pending_;
  std::deque<Outcome> outcomes_;
};

}  // namespace sightline
