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
  [[nodiscard]] bool may_be_visible(ObjectId id, const Aabb& world_bounds) const {
    if (moved.is_absent(id)) return false;
    if (fallback != Fallback::none || is_seen(id)) return true;
    if (field_covered && moved.draws_nothing()) return false;
    return moved.must_draw(id, world_bounds) || may_be_untested(world_bounds);
  }
  /// Whether the object is in `visible` or its bits.
  [[nodiscard]] bool is_seen(ObjectId id) const {
    const std::size_t word = index_of(id) / 64;
    if (word < visible_bits.size()) return (visible_bits[word] >> (index_of(id) % 64) & 1) != 0;
    return visible_bits.empty() && visible.contains(id);
  }
  /// Whether the box may reach into a part of the view that no set has looked at.
  [[nodiscard]] bool may_be_untested(const Aabb& world_bounds) const;

  Fallback fallback = Fallback::no_set;
  /// S_last OR S_next, with every later set at hand: see all_after. Of decide(); empty in a ViewFrame, which
  /// has the bits alone.
  VisibleSet visible;
  std::vector<std::uint64_t> visible_bits;  ///< the same, a bit an object as far as its last; or empty
  std::size_t visible_count = 0;            ///< bits that are set
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
  /// The same where the eyes differ little, as those of a lens that zooms or of a light that follows the
  /// camera: the sets at hand stay, and what they have not looked at is drawn. Requires as many eyes.
  void adjust_rig(std::vector<RigEye> rig);

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

  /// Objects that are boxes, and where these are at `now_s`: what the application added (in a spare id),
  /// replaced by other geometry, or deforms. Every request carries their boxes from now on, also while they
  /// stand; they hide nothing, and are drawn until a set knows them and unless the whole box is hidden. Give
  /// the boxes that changed, before decide of that frame; any others do no harm; or give their placements to
  /// move_objects from then on.
  ///
  /// Declare before what the daemon's scene has geometry for: that leaves its shadow as a mover does. An id
  /// of which nothing was said is taken for a spare, which hid nothing. hide_objects and show_objects hold
  /// for boxes as well: to remove one is to hide it. Throws InputError for a box that is not finite, is empty
  /// or has min above max; nothing changed then.
  void box_objects(double now_s, std::span<const BoxedPlacement> objects);
  /// The same for the boxes around bounds in the objects' own frames.
  void box_objects(double now_s, std::span<const MovedObject> objects);
  /// These are again what the daemon's scene has, where declare_objects or move_objects placed them last. A
  /// spare, of which it has nothing, is hidden. Ids that are not boxed are ignored.
  void unbox_objects(std::span<const ObjectId> ids);

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

  /// What is seen through these very eyes at `now_s`, unwidened, for a client that waits for the answer.
  /// Needs no pose.
  [[nodiscard]] ViewRequest make_exact_request(double now_s, ImageSize main_size, std::span<const Eye> eyes);

  /// The next request's number: for a core that takes another one's place in a session. Call it before the
  /// first request.
  void number_requests_from(std::uint64_t request_seq) noexcept;
  [[nodiscard]] std::uint64_t next_request_seq() const noexcept { return next_request_seq_; }
  /// The lowest number among the requests whose answers may still be used at `now_s` or later.
  [[nodiscard]] std::optional<std::uint64_t> oldest_filed_request(double now_s) const noexcept;

  /// Files an answer under the time it is for. `request` is the one it answers; answers to requests from
  /// before the last jump or new rig are dropped. The round trip (received - issued) moves the horizon.
  void accept(ViewRequest request, double issued_s, VisibleSet set, double received_s);

  /// The daemon or its session is gone: forget all sets. All moved objects will be told anew.
  void forget_sets();

  /// What to draw at `now_s` through `eyes`. A set is usable when it is for nearly this time, has as many
  /// eyes and was asked from nearly here (see CullingOptions). S_last and S_next are united; one alone will
  /// do.
  [[nodiscard]] FrameDecision decide(double now_s, std::span<const Eye> eyes) const;
  /// The same, but for `visible`: it is in `visible_bits` alone.
  [[nodiscard]] FrameDecision decide_in_bits(double now_s, std::span<const Eye> eyes) const;

  [[nodiscard]] double horizon_s() const noexcept;
  [[nodiscard]] const std::vector<RigEye>& rig() const noexcept { return rig_; }

 private:
  [[nodiscard]] ViewRequest begin_request(double for_time_s, ImageSize main_size);
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
