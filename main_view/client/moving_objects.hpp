#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "common/bounds.hpp"
#include "common/object_id.hpp"
#include "main_view/client/box_motion.hpp"
#include "main_view/client/cast_shadows.hpp"
#include "main_view/client/foretold_boxes.hpp"
#include "main_view/client/id_slots.hpp"
#include "main_view/client/motion_blocks.hpp"
#include "main_view/client/moved_in_frame.hpp"
#include "main_view/client/told_history.hpp"
#include "main_view/client/visible_set_timeline.hpp"
#include "protocol/messages.hpp"

namespace sightline {

/// Where an object is, as the application says it.
struct MovedObject {
  ObjectId id{};
  glm::dmat4x3 world_from_object{1.0};  ///< world frame, metres
  Aabb object_bounds;                   ///< object's own frame; must hold all that it draws
};

/// Where an object is of which nobody but the application knows the shape.
struct BoxedPlacement {
  ObjectId id{};
  WorldBox world_bounds;  ///< world frame, metres; must hold all that it draws
};

/// The client's account of objects that do not stand where the scene file has them, and of what each request
/// said about them.
///
/// An object is at rest, on the move, or absent. At rest it is an occluder like any other: the daemon is told
/// its placement once. On the move it is carried by every request as a box that holds it while the answer may
/// be used; it hides nothing then. It comes to rest after k_rest_intervals answers without a change. An
/// object that is boxed for good counts as on the move even while it stands: its shape is not the daemon's.
///
/// What a set does not know is made good here: an object is drawn wherever it is not what each set in use
/// took it for, and so is all that it may have hidden where it stood as an occluder and no longer stands.
///
/// Error: towards drawing, provided that bounds hold and that all placements are told before decide.
/// Cost: follows the objects that changed lately, not those declared; nothing is allocated for an object that
/// goes on moving.
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
  /// moved of which nobody said where it stood: no set from before is of any use then. An object that is
  /// boxed is the box around these bounds, and stands there when it is geometry again.
  [[nodiscard]] bool move(double now_s, double last_frame_s, std::span<const MovedObject> objects);
  /// These are boxes at `now_s` and boxed from now on. One that nothing was said of before is a spare: the
  /// scene has no geometry for it. Returns false as above. What is hidden stays so.
  [[nodiscard]] bool box(double now_s, double last_frame_s, std::span<const BoxedPlacement> objects);
  /// These are what the daemon's scene has again, where they were placed last. A spare is then absent.
  void unbox(std::span<const ObjectId> ids);
  /// Returns false as above.
  [[nodiscard]] bool hide(std::span<const ObjectId> ids);
  void show(std::span<const ObjectId> ids);

  /// Writes moves, boxes and presence into a request that is for sure sent after this call, or never.
  void write(ViewRequest& request, double now_s, const Usage& usage);
  /// A set answers request `request_seq`.
  void acknowledge(std::uint64_t request_seq) noexcept;
  /// The daemon has begun anew from the scene file: all is told again.
  void forget_told();

  /// What `used` do not know of. Cost follows the objects that changed lately, times the sets.
  [[nodiscard]] MovedInFrame judge(std::span<const FiledSet* const> used) const;

  /// Answers without a change after which an object counts as resting, and the least time.
  static constexpr double k_rest_intervals = 3.0;
  static constexpr double k_least_rest_s = 0.1;
  /// Shadows a frame tests every object against; beyond, drawing all is cheaper than asking.
  static constexpr std::size_t k_most_shadows = 256;

 private:
  /// As the scene file has an object that never moved.
  struct Declared {
    glm::dmat4x3 world_from_object{1.0};
    Aabb object_bounds;
  };
  /// What every frame looks at; the rest is in arrays of its own, by the same slot.
  struct Standing {
    std::uint64_t boxed_since = k_never_told;  ///< requests from here on carry its box
    ObjectId id{};
    std::uint32_t box_slot = IdSlots::k_none;  ///< of its BoxCourse, once it had one
    ObjectState state = ObjectState::resting;
    bool steady : 1 = false;       ///< on the move, and all requests that may be answered say so
    bool active : 1 = false;       ///< listed in active_
    bool placed : 1 = false;       ///< its placement is known
    bool as_in_file : 1 = false;   ///< it never moved
    bool never_hidden : 1 = true;  ///< the daemon need not be told that it is there
    bool boxed : 1 = false;        ///< for good
    bool spare : 1 = false;        ///< the scene has no geometry for it
    bool under_way : 1 = false;    ///< listed in under_way_
  };
  /// Of an object that is boxed for good.
  struct BoxCourse {
    WorldBox bounds;  ///< where it is now
    BoxMotion motion;
    double changed_s = 0.0;
    double error_m = 0.0;             ///< how far what was foretold of it was off
    double error_s = 0.0;             ///< as of this time
    std::int32_t foretold_since = 0;  ///< columns from this one on are about it
  };
  struct News {
    ToldHistory told;
    Delivery move, presence;
  };

  std::uint32_t slot_of(ObjectId id);
  std::uint32_t add_slot(ObjectId id);
  void activate(std::uint32_t slot);
  void list_newcomers();
  void set_state(std::uint32_t slot, ObjectState state) noexcept;
  void begin_moving(std::uint32_t slot) noexcept;
  void forget_foretold(std::uint32_t slot) noexcept;
  void place(std::uint32_t slot, const MovedObject& given);
  /// Where it is now.
  [[nodiscard]] WorldBox bounds_of(std::uint32_t slot) const noexcept {
    const Standing& object = standing_[slot];
    if (object.boxed) return boxes_[object.box_slot].bounds;
    if (object.placed) return motions_.bounds(slot);
    constexpr double k_infinity = std::numeric_limits<double>::infinity();
    return {glm::dvec3(-k_infinity), glm::dvec3(k_infinity)};
  }
  void step_box(std::uint32_t slot, double now_s, double last_frame_s, const WorldBox& bounds,
                const ForetoldBoxes::Covering& covering);
  void learn(std::uint32_t slot, double now_s, const ForetoldBoxes::Covering& covering) noexcept;
  void stop(std::uint32_t slot) noexcept;

  /// A request in the making.
  struct Asking {
    ForetellTimes times;
    ForetoldBoxes::Covering covering;
    ForetoldBoxes::Column* column = nullptr;  ///< null where this one's boxes are not kept
  };
  void foretell_block(std::size_t block, const Asking& asking);
  void foretell_turning(std::uint32_t slot, const Asking& asking, BoxRows& way);
  [[nodiscard]] WorldBox box_of_boxed(std::uint32_t slot, const Asking& asking);
  void tell(std::uint32_t slot, std::uint64_t seq, double now_s, double keep_s);
  void deliver(std::uint32_t slot, ViewRequest& request);
  [[nodiscard]] bool is_quiet(std::uint32_t slot) const noexcept;

  /// What the set knows wrong of the object. Whether the object itself has to be drawn for it.
  [[nodiscard]] bool misjudged(std::uint32_t slot, const FiledSet& filed, const BoxedObject* box,
                               std::vector<ShadowToBe>& shadows, bool& everything) const;

  IdSlots declared_slots_, slots_;
  std::vector<Declared> declared_;
  std::vector<Standing> standing_;
  MotionBlocks motions_;
  std::vector<News> news_;
  std::vector<BoxCourse> boxes_;          ///< by box_slot
  std::vector<std::uint32_t> active_;     ///< slots, by ascending ids: all but those at rest (or absent) that
                                          ///< every request at hand agrees about
  std::vector<std::uint32_t> newcomers_;  ///< to active_
  std::vector<std::uint32_t> under_way_;  ///< slots with deliveries sent and not acknowledged
  std::vector<ObjectId> absent_;          ///< ascending
  ForetoldBoxes foretold_;

  // By blocks of motions_.
  std::vector<std::uint8_t> moving_lanes_;  ///< a bit each: on the move and not boxed for good
  std::vector<BoxRows> asked_;              ///< what the newest request says
  std::vector<std::uint64_t> asked_in_;     ///< which that is
  std::uint64_t write_count_ = 0;
};

}  // namespace sightline
