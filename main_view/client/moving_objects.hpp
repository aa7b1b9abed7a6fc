#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <span>
#include <vector>

#include "common/bounds.hpp"
#include "common/object_id.hpp"
#include "main_view/client/object_motion.hpp"
#include "main_view/client/occluder_shadow.hpp"
#include "main_view/client/visible_set_timeline.hpp"
#include "protocol/messages.hpp"

namespace sightline {

/// Where an object is, as the application says it.
struct MovedObject {
  ObjectId id{};
  glm::dmat4x3 world_from_object{1.0};  ///< world frame, metres
  Aabb object_bounds;                   ///< object's own frame; must hold all that it draws
};

/// What the objects that moved, came or went add to a frame's decision.
struct MovedInFrame {
  std::vector<ObjectId> absent;         ///< not there: not drawn, whatever else holds; ascending
  std::vector<ObjectId> untested;       ///< no set in use looked for them where they are: drawn; ascending
  std::vector<OccluderShadow> shadows;  ///< where a set in use may have missed what is no longer hidden
  bool everything = false;              ///< more shadows than are worth testing: all in the view is drawn

  [[nodiscard]] bool is_absent(ObjectId id) const noexcept;
  [[nodiscard]] bool must_draw(ObjectId id, const Aabb& world_bounds) const noexcept;
};

/// The client's account of objects that do not stand where the scene file has them, and of what each request
/// said about them.
///
/// An object is at rest, on the move, or absent. At rest it is an occluder like any other: the daemon is told
/// its placement once. On the move it is carried by every request as a box that holds it while the answer may
/// be used; it hides nothing then. It comes to rest after k_rest_intervals answers without a change.
///
/// What a set does not know is made good here: an object is drawn wherever it is not what each set in use
/// took it for, and so is all that it may have hidden where it stood as an occluder and no longer stands.
///
/// Error: towards drawing, provided that `object_bounds` hold and that all placements are told before decide.
class MovingObjects {
 public:
  /// How the times of requests and answers lie; from the horizon's measurements.
  struct Usage {
    double from_s = 0.0;      ///< the answer may be used for frames from here
    double until_s = 0.0;     ///< to here
    double interval_s = 0.0;  ///< between answers
    double keep_s = 1.0;      ///< requests older than this are answered no more
  };

  /// Where objects stand in the scene file, so that the first move of each costs nothing.
  void declare(std::span<const MovedObject> objects);
  /// Placements at `now_s`; `last_frame_s` is when the frame before was drawn. Returns false when an object
  /// moved of which nobody said where it stood: no set from before is of any use then.
  [[nodiscard]] bool move(double now_s, double last_frame_s, std::span<const MovedObject> objects);
  /// Returns false as above.
  [[nodiscard]] bool hide(std::span<const ObjectId> ids);
  void show(std::span<const ObjectId> ids);

  /// Writes moves, boxes and presence into a request that is for sure sent after this call, or never.
  void write(ViewRequest& request, double now_s, const Usage& usage);
  /// A set answers request `request_seq`.
  void acknowledge(std::uint64_t request_seq) noexcept;
  /// The daemon has begun anew from the scene file: all is told again.
  void forget_told() noexcept;

  /// What `used` do not know of. Cost follows the objects that changed lately, times the sets.
  [[nodiscard]] MovedInFrame judge(std::span<const FiledSet* const> used) const;

  /// Answers without a change after which an object counts as resting, and the least time.
  static constexpr double k_rest_intervals = 3.0;
  static constexpr double k_least_rest_s = 0.1;
  /// Eyes no further apart share a shadow, metres: a little larger, and asked about once.
  static constexpr double k_shared_shadow_m = 0.3;
  /// Foretold boxes that are kept to learn from.
  static constexpr std::size_t k_most_foretold = 6;
  /// Shadows a frame tests every object against; beyond, drawing all is cheaper than asking.
  static constexpr std::size_t k_most_shadows = 256;

 private:
  enum class State : std::uint8_t { unknown, resting, moving, absent };

  /// What requests from `first_seq` on say of the object, until the next such entry.
  struct Told {
    std::uint64_t first_seq = 0;
    double time_s = 0.0;
    State state = State::unknown;
    glm::dmat4x3 world_from_object{1.0};  ///< resting
    WorldBox bounds;                      ///< resting
  };
  struct Foretold {
    double from_s = 0.0, until_s = 0.0;
    WorldBox bounds;  ///< as extrapolated, not widened
  };
  /// A message that is repeated until a request that carried it is answered.
  struct Delivery {
    bool due = false;
    std::uint64_t first_seq = 0;  ///< 0: not sent yet
    void begin() noexcept { *this = {true, 0}; }
    void send(std::uint64_t seq) noexcept {
      if (first_seq == 0) first_seq = seq;
    }
    void acknowledge(std::uint64_t seq) noexcept {
      if (first_seq != 0 && seq >= first_seq) due = false;
    }
  };
  struct Tracked {
    ObjectMotion motion;
    WorldBox bounds{};         ///< where it is now
    bool placed = false;       ///< its placement is known
    bool as_in_file = false;   ///< it never moved
    bool never_hidden = true;  ///< the daemon need not be told that it is there
    State state = State::resting;
    double changed_s = 0.0;
    Delivery move{}, presence{};
    std::vector<Told> told{};  ///< ascending first_seq
    std::deque<Foretold> foretold{};
    double error_m = 0.0;  ///< what extrapolations lately missed by
    double error_s = 0.0;  ///< as of this time
  };

  Tracked& track(ObjectId id);
  void learn(Tracked& object, double now_s) const;
  void settle(Tracked& object, double now_s, const Usage& usage) const;
  void tell(Tracked& object, std::uint64_t seq, double now_s) const;
  [[nodiscard]] WorldBox box_of(Tracked& object, double now_s, const Usage& usage) const;
  [[nodiscard]] static bool is_quiet(const Tracked& object) noexcept;
  /// A shadow to be: of one old place, for viewpoints near one eye.
  struct Cast {
    const Told* told = nullptr;
    const Eye* eye = nullptr;
    double slack_m = 0.0;
  };
  /// What the set knows wrong of the object. Whether the object itself has to be drawn for it.
  [[nodiscard]] static bool misjudged(ObjectId id, const Tracked& object, const FiledSet& filed,
                                      std::vector<Cast>& casts, bool& everything);
  static void cast(const Told& told, const ViewRequest& request, std::vector<Cast>& casts);

  std::map<ObjectId, Tracked> objects_;
  std::set<ObjectId> active_;  ///< all but those at rest that every request at hand agrees about
  std::set<ObjectId> absent_;
};

}  // namespace sightline
