#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "common/pose.hpp"
#include "main_view/client/error_region.hpp"
#include "main_view/client/fit_bank.hpp"
#include "main_view/client/fit_blend.hpp"
#include "main_view/client/pose_history.hpp"
#include "main_view/client/predicted_pose.hpp"

namespace sightline {

/// Where the camera will be, by a prediction that adapts to how it moves.
///
/// A bank of least-squares polynomials (FitBank) is extrapolated, and the results are blended with the
/// weights that would have predicted best of late, at this lead (FitBlend): the poses that since arrived are
/// the judges. So order, window, discount and damping follow the motion, for each axis of the head by itself:
/// nodding and shaking obey other habits than rolling. Rotations are vectors about the newest pose, in its
/// own frame, as in S. M. LaValle, A. Yershova, M. Katsev, M. Antonov, "Head Tracking for the Oculus Rift",
/// 2014, who predict with a constant rate or a constant acceleration of that vector.
///
/// The announced region is learnt in the same way, see ErrorRegion. In no past is the first turn after a long
/// calm, so the region is never smaller than what a head that begins to move may do: k_start_turn_rad_per_s2
/// and k_start_m_per_s2 over the lead. A camera that never moved announces none.
///
/// What was learnt outlives pauses and jumps; the poses do not. A pose far from all that the motion so far
/// explains is not believed until the next one bears it out: a single stray pose moves no prediction, and
/// the region reaches out to it meanwhile.
class AdaptivePredictor {
 public:
  AdaptivePredictor();

  static constexpr double k_start_turn_rad_per_s2 = 7.0;  ///< 400 degrees/s^2: a brisk glance
  static constexpr double k_start_m_per_s2 = 0.5;         ///< someone who sets off gently

  /// Takes in the poses that the history has got since the last call. A history that was cleared meanwhile
  /// starts a new motion.
  void observe(const PoseHistory& history);

  /// The pose at `time_s`, in the client's clock; with a time at or before the newest pose's, that pose.
  [[nodiscard]] PredictedPose predict(const PoseHistory& history, double time_s);

 private:
  /// Leads that are learnt, each the square root of 2 times the one before: 1/60 s to about 1 s.
  static constexpr std::size_t k_lead_count = 13;

  /// What was foretold at one pose for one of the leads.
  struct Forecast {
    double lead_s = 0.0;
    LocalMotion motion{};
    ForecastDoubt doubt_m;
    ForecastDoubt doubt_rad;
    double radius_m = 0.0;
    double radius_rad = 0.0;
  };
  struct Record {
    TimedPose at;
    FitBank bank;
    bool first = false;  ///< made from the first poses of a motion, which hardly tell its speed
    std::array<Forecast, k_lead_count> forecasts;
  };
  /// How far off, metres and radians.
  struct Regions {
    ErrorRegion m;
    ErrorRegion rad;
  };
  struct Lead {
    FitBlend blend;
    Regions regions;
    Regions first_regions;  ///< of first records, which are no measure for the others
    std::size_t next = 0;   ///< first record whose forecast has not been judged
  };

  void forget_motion();
  void take(const TimedPose& sample);
  void take_believed(const TimedPose& sample);
  void replace_newest(const TimedPose& sample);
  /// How a pose differs from the one that the quickest fit expects then. Requires a record.
  [[nodiscard]] LocalMotion surprise_of(const TimedPose& sample) const;
  [[nodiscard]] bool is_stray(const LocalMotion& surprise) const noexcept;
  void get_used_to(const LocalMotion& surprise, double share, double step_s) noexcept;
  void judge_forecasts(const TimedPose& before, const TimedPose& now);
  void make_record();
  void announce(const Record& record, const Lead& lead, double likely_m, double likely_rad,
                Forecast& forecast) const;
  void drop_old_records();
  /// For any lead, between the learnt ones.
  [[nodiscard]] Forecast forecast_at(const Record& record, double lead_s) const;
  [[nodiscard]] double pose_interval_s() const noexcept;

  std::vector<TimedPose> samples_;  ///< believed, at most k_fit_bank_window, oldest first
  std::optional<TimedPose> stray_;  ///< newest pose, while not believed
  std::deque<Record> records_;
  std::array<Lead, k_lead_count> leads_;
  std::size_t next_solved_ = 0;
  bool has_moved_ = false;   ///< ever: two poses differed
  double surprise_m_ = 0.0;  ///< largest of late by which a pose differed from the one expected next
  double surprise_rad_ = 0.0;
  std::optional<TimedPose> newest_;  ///< taken from the history, believed or not
};

}  // namespace sightline
