#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "common/bounds.hpp"
#include "common/frustum.hpp"
#include "common/pose.hpp"
#include "common/view.hpp"
#include "main_view/client/culling_options.hpp"
#include "main_view/client/field_coverage.hpp"
#include "main_view/client/horizon_estimator.hpp"
#include "main_view/client/motion_predictor.hpp"
#include "main_view/client/pose_history.hpp"
#include "main_view/client/visible_set_timeline.hpp"
#include "protocol/messages.hpp"
#include "protocol/visible_set.hpp"

namespace sightline {

/// An eye of the client's rig: where it sits on the head and how it projects.
struct RigEye {
  glm::dmat4 camera_from_head{1.0};  ///< rigid; identity for a single eye
  glm::dmat4 clip_from_camera{1.0};
};

/// The eyes of a head pose. Renderer and request both call this one function, so a pose that was predicted
/// exactly gives matrices that are equal to the bit.
[[nodiscard]] std::vector<Eye> eyes_of(const Pose& head, std::span<const RigEye> rig);

enum class Fallback {
  none,
  no_set,  ///< nothing has arrived yet, or since the last jump, moved object, new rig or lost session
  stale    ///< the nearest sets are too far from now
};

/// What a set's eye did not see of an eye of the frame. Nothing when `cuts` is empty.
struct TestedField {
  std::size_t eye = 0;
  std::vector<CutOff> cuts;
};

/// What one frame draws.
class FrameDecision {
 public:
  /// Whether to draw the object. Errs towards true: true for everything when there is no usable set, for
  /// every object of S_last OR S_next, and for one whose `world_bounds` may reach into the part of the view
  /// frustum that neither set's field covered (nobody has tested it there). View-frustum culling is the
  /// caller's.
  [[nodiscard]] bool may_be_visible(ObjectId id, const Aabb& world_bounds) const;

  Fallback fallback = Fallback::no_set;
  VisibleSet visible;               ///< S_last OR S_next, with every later set at hand: see all_after
  bool field_covered = false;       ///< the whole view frustum was tested; world_bounds is then not looked at
  std::vector<Frustum> tested;      ///< the widened fields of S_last and S_next, world frame; for display
  std::vector<TestedField> fields;  ///< without field_covered: what may_be_visible decides by
  std::size_t eye_count = 1;
  std::optional<double> last_age_s;   ///< now - time of S_last, when used
  std::optional<double> next_lead_s;  ///< time of S_next - now, when used
};

/// Everything the client decides, without sockets and without a clock: time is an argument, seconds of the
/// client's monotonic clock. `play` drives it with real time, `audit` with a virtual one.
///
///   add_pose -> make_request -> (wire) -> accept -> decide
class CullingCore {
 public:
  /// Throws InputError naming the option that is wrong.
  CullingCore(CullingOptions options, std::vector<RigEye> rig);

  /// The camera now. A jump (see PoseHistory) clears the history and the timeline, and requests ask the
  /// daemon to reset its filter until one of them was answered (a request may be superseded on the way). A
  /// time before the newest pose's is ignored. Throws InputError for a pose that is not finite; nothing
  /// changed then.
  void add_pose(const TimedPose& head);

  /// Other eyes from now on, as after a resized window: the sets at hand were tested through other
  /// projections and are forgotten. Requests keep their numbering, so that the session goes on. Throws
  /// InputError for a rig that the constructor would refuse; nothing changed then.
  void set_rig(std::vector<RigEye> rig);

  /// Objects' new placements. Each goes out with every request until a set arrives that answers one, and
  /// again to a daemon that comes back. A placement that differs from the object's last one makes all sets
  /// asked for before it useless, for they also leave out what the object hid where it was: everything in the
  /// frustum is drawn until a newer one arrives, so always while something moves in every frame. Throws
  /// InputError for a placement that is not finite; nothing changed then.
  void move_objects(std::span<const ObjectMove> moves);

  /// The view expected at now + horizon. session_id and acked_set_seq are the link's to fill.
  /// With a horizon of zero and now at the newest pose's time it is that very pose, unwidened. Otherwise
  /// rotation_error_rad is the guard: the predictor's error plus what the camera turns between two answers,
  /// within min_guard_rad and max_guard_rad. Throws InputError without a pose.
  [[nodiscard]] ViewRequest make_request(double now_s, ImageSize main_size);

  /// Files an answer under the time it is for. `request` is the one it answers; answers to requests from
  /// before the last jump, move or new rig are dropped. The round trip (received - issued) moves the horizon.
  void accept(const ViewRequest& request, double issued_s, const VisibleSet& set, double received_s);

  /// The daemon or its session is gone: forget all sets. All moved objects will be told anew.
  void forget_sets();

  /// What to draw at `now_s` through `eyes`. A set is usable when it is for nearly this time, has as many
  /// eyes and was asked from nearly here (see CullingOptions). S_last and S_next are united; one alone will
  /// do.
  [[nodiscard]] FrameDecision decide(double now_s, std::span<const Eye> eyes) const;

  [[nodiscard]] double horizon_s() const noexcept;
  [[nodiscard]] const std::vector<RigEye>& rig() const noexcept { return rig_; }

 private:
  /// A moved object: where it is, and the first request that said so (0: none yet).
  struct Placement {
    glm::dmat4x3 world_from_object{1.0};
    std::uint64_t first_request_seq = 0;
    bool acknowledged = false;
  };

  [[nodiscard]] double guard_rad(const PredictedPose& predicted) const noexcept;
  [[nodiscard]] bool usable(const FiledSet& filed, double now_s, std::span<const Eye> eyes) const;
  /// No set at hand or on its way serves any longer.
  void drop_sets() noexcept;

  CullingOptions options_;
  std::vector<RigEye> rig_;
  PoseHistory history_;
  MotionPredictor predictor_;
  HorizonEstimator horizon_;
  VisibleSetTimeline timeline_;
  std::map<ObjectId, Placement> placements_;
  std::uint64_t next_request_seq_ = 1;
  std::uint64_t first_valid_request_seq_ = 1;
  bool reset_pending_ = true;
};

}  // namespace sightline
