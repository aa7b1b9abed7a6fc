#pragma once

#include <deque>
#include <vector>

#include "common/pose.hpp"
#include "main_view/client/culling_options.hpp"
#include "main_view/client/polynomial_fit.hpp"
#include "main_view/client/pose_history.hpp"

namespace sightline {

/// A pose that is expected, and how far off it may be.
struct PredictedPose {
  Pose pose;
  double position_error_m = 0.0;
  double rotation_error_rad = 0.0;
};

/// Where the camera will be, from where it was.
///
/// Klimenko, Nikitina, Nikitin, "Parallel Visibility Test and Occlusion Culling in Avango Virtual Environment
/// Framework": a least-squares polynomial of order n over the last p poses for each of x, y, z and the
/// quaternion's components, which are normalised afterwards. While there are fewer than n + 1 poses the order
/// is lower.
///
/// Ours in addition: the error estimate. It is the larger of k_fit_error_factor standard deviations of the
/// fit's own prediction, and k_memory_error_factor times the largest error that predictions about as far
/// ahead made in the last k_error_memory_s. Recorded head and hand motion (60 Hz, 5 frames ahead) lies within
/// it 97 times in 100 or more; with no margin on the memory, 91. It errs either way: a sudden turn is in no
/// data before it.
///
/// Cost at order 2 over 20 on one core: 9 us with ceres::TinySolver, 74 us with ceres::Problem, 4 us for one
/// QR factorization in closed form (tests/client/bench_predictor.cpp; a shared AMD EPYC, GCC 12).
class MotionPredictor {
 public:
  explicit MotionPredictor(const CullingOptions& options);

  /// The pose at `time_s`, in the client's clock. At or before the newest pose's time: that pose exactly,
  /// with no error. A history that stands still predicts itself exactly, with no error. Requires a pose in
  /// the history. Remembers the prediction until its time has come.
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

  [[nodiscard]] PredictedPose extrapolate(const PoseHistory& history, double time_s);

  int order_;
  int window_;
  std::vector<double> times_s_;         // scratch of extrapolate
  std::vector<PoseComponents> values_;  // likewise
  std::deque<Pending> pending_;
  std::deque<Outcome> outcomes_;
};

}  // namespace sightline
