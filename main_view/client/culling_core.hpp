#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
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
#include "main_view/client/moving_objects.hpp"
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
  no_set,  ///< nothing has arrived yet, or since the last jump, new rig or lost session
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
  /// frustum that neither set's field covered (nobody has tested it there). So it does for an object that
  /// moved, where no set in use looked for it, and for all that it may have hidden where it was. False
  /// without exception for one that is hidden by hide_objects. View-frustum culling is the caller's.
  [[nodiscard]] bool may_be_visible(ObjectId id, const Aabb& world_bounds) const;

  Fallback fallback = Fallback::no_set;
  VisibleSet visible;               ///< S_last OR S_next, with every later set at hand: see all_after
  bool field_covered = false;       ///< the whole view frustum was tested; world_bounds is then not looked at
  std::vector<Frustum> tested;      ///< the widened fields of S_last and S_next, world frame; for display
  std::vector<TestedField> fields;  ///< without field_covered: what may_be_visible decides by
  MovedInFrame moved;               ///< objects that moved, came or went
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

  /// Objects that may move, as the scene file has them: call it once, before the first request. An object
  /// that was never declared is told as well, but when it first moves nobody knows what it hid, so everything
  /// in the frustum is drawn until a set knows it. Throws InputError for what is not finite; nothing changed
  /// then.
  void declare_objects(std::span<const MovedObject> objects);

  /// Objects' placements at `now_s`, for those that changed (any others do no harm), before decide of that
  /// frame. Objects may move in every frame: while one does, requests carry it as a box where it will be when
  /// the answer is used, and it hides nothing; when it has rested for a few answers it becomes an occluder
  /// where it is. What the sets at hand do not know is drawn, see MovingObjects: no frame falls back and
  /// none is wrong for it. Throws InputError for what is not finite; nothing changed then.
  void move_objects(double now_s, std::span<const MovedObject> objects);

  /// Objects that are not there from now on: not drawn, whatever the sets say, and hiding nothing.
  void hide_objects(std::span<const ObjectId> ids);
  /// Objects that are there again, where they were last placed: drawn until a set knows them. At first all
  /// objects are there.
  void show_objects(std::span<const ObjectId> ids);

  /// The view expected at now + horizon. session_id and acked_set_seq are the link's to fill.
  /// With a horizon of zero and now at the newest pose's time it is that very pose, unwidened. Otherwise
  /// rotation_error_rad is the guard: the predictor's error plus what the camera turns between two answers,
  /// within min_guard_rad and max_guard_rad. Throws InputError without a pose.
  [[nodiscard]] ViewRequest make_request(double now_s, ImageSize main_size);

  /// Files an answer under the time it is for. `request` is the one it answers; answers to requests from
  /// before the last jump or new rig are dropped. The round trip (received - issued) moves the horizon.
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
  MovingObjects moving_;
  SmoothedValue use_lead_;  ///< by how much answers come before the time they are for
  double last_frame_s_ = -std::numeric_limits<double>::infinity();  ///< the frame before the newest pose's
  double frame_s_ = -std::numeric_limits<double>::infinity();       ///< the newest pose's
  std::uint64_t next_request_seq_ = 1;
  std::uint64_t first_valid_request_seq_ = 1;
  bool reset_pending_ = true;
};

}  // namespace sightline
