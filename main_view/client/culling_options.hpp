#pragma once

#include <string_view>

namespace sightline {

/// How the camera is predicted (see MotionPredictor).
enum class PredictorKind {
  adaptive,  ///< order, window and damping follow the motion
  fixed      ///< predictor_order over predictor_window, as in the Avango paper
};

/// What an application may choose about prediction, horizon, guard and staleness. Every field has a working
/// default.
struct CullingOptions {
  /// Throws InputError naming the first field that is out of its range.
  void validate() const;

  // Motion prediction. The two numbers are for the fixed one: order n over the last p poses (the paper's 2
  // and 20). The adaptive one is nearer to the truth and announces narrower regions, so it is the default.
  PredictorKind predictor = PredictorKind::adaptive;
  int predictor_order = 2;    ///< 0 to k_max_predictor_order
  int predictor_window = 20;  ///< poses, 1 to k_max_predictor_window

  // What is a jump rather than a motion (see PoseHistory).
  double jump_distance_m = 0.5;             ///< a step this long needs no motion to explain it
  double jump_speed_factor = 4.0;           ///< further than this times recent speed * dt beyond it: a jump
  double jump_rotation_rad = 0.35;          ///< likewise for a turn: 20 degrees
  double jump_turn_speed_rad_per_s = 15.7;  ///< and the fastest head turn there is: 900 degrees a second
  double pose_gap_s = 0.5;  ///< a longer pause: older poses no longer say how the camera moves

  // Horizon (see HorizonEstimator).
  double initial_horizon_s = 0.0;  ///< until a round trip was measured; 0 asks for the current view
  double max_horizon_s = 0.5;

  // Guard: how far the tested field reaches beyond the view. Only where something is predicted: with a
  // horizon of zero the view is known and nothing is added.
  double min_guard_rad = 0.175;  ///< 10 degrees
  double max_guard_rad = 0.524;  ///< 30 degrees; a wider field leaves fewer pixels for what is in view

  // What a frame is drawn from. Off is the paper's way.
  bool unite_all_later_sets = true;  ///< every set for a time after now, rather than the nearest alone
  bool draw_untested =
      true;  ///< also what may reach into a part of the view that no set in use has looked at

  // When a set says too little about now.
  double max_staleness_s = 0.3;        ///< oldest S_last
  double max_position_offset_m = 0.5;  ///< eye now against eye of the request, beyond what the speed explains
};

/// The client's part of a named preset; `control_view --preset` has the daemon's. "default", or "avango" for
/// the paper to the letter: order 2 over 20 poses, the field that was predicted and no wider, and of the
/// answers the nearest before now OR the nearest after (Klimenko, Nikitina, Nikitin, "Parallel Visibility
/// Test and Occlusion Culling in Avango Virtual Environment Framework", 2003). What keeps a lost daemon from
/// costing the picture (jumps, staleness) stays as it is. Throws InputError for another name.
[[nodiscard]] CullingOptions culling_options_of_preset(std::string_view name);

/// Beyond a cubic an extrapolation follows the noise; each order is also one more instance of the solver to
/// compile.
inline constexpr int k_max_predictor_order = 3;
inline constexpr int k_max_predictor_window = 240;

}  // namespace sightline
