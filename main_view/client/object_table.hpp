#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "main_view/client/moving_objects.hpp"
#include "main_view/client/object_bits.hpp"
#include "main_view/client/object_ids.hpp"
#include "main_view/client/placed_bounds.hpp"
#include "main_view/client/scene_objects.hpp"

namespace sightline {

/// What was edited since the last frame, as CullingCore wants to be told.
struct ObjectEdits {
  std::vector<MovedObject> declared;  ///< as the scene has them, before anything else is said of them
  std::vector<MovedObject> boxed;     ///< hide nothing from now on, and are tested by these bounds
  std::vector<MovedObject> moved;     ///< ascending ids
  std::vector<ObjectId> hidden;
  std::vector<ObjectId> shown;
  std::vector<ObjectId> removed;  ///< of those hidden: ids to retire

  void clear() noexcept;
};

/// The objects of a client: as the scene has them, as the application has edited them, and how they take
/// part. Every edit throws InputError for what it cannot do, and has changed nothing then.
class ObjectTable {
 public:
  /// Shares the scene, which never changes, with the client that describes it. Throws InputError for bounds
  /// or placements that are not finite and for unknown flags.
  explicit ObjectTable(std::shared_ptr<const SceneObjects> scene);

  void move(std::span<const ObjectId> ids, std::span<const glm::dmat4x3> world_from_object);
  void hide(std::span<const ObjectId> ids);
  void show(std::span<const ObjectId> ids);
  std::optional<ObjectId> add(const SceneObject& object);
  void remove(ObjectId id);
  void set_bounds(std::span<const ObjectId> ids, std::span<const Aabb> object_bounds);
  /// Only always_visible may change.
  void set_flags(ObjectId id, std::uint32_t flags);

  /// The edits since the last call; `edits` is overwritten. Call once a frame.
  void take_edits(ObjectEdits& edits);
  /// Everything that differs from the scene, for a view that begins now.
  void all_edits(ObjectEdits& edits) const;

  [[nodiscard]] ObjectIds& ids() noexcept { return ids_; }
  [[nodiscard]] const ObjectIds& ids() const noexcept { return ids_; }
  [[nodiscard]] const PlacedBounds& bounds() const noexcept { return bounds_; }
  [[nodiscard]] const SceneDigest& scene_digest() const noexcept { return scene_->digest; }
  [[nodiscard]] std::uint32_t object_count() const noexcept { return bounds_.object_count(); }
  /// Throws InputError for an id that the scene has not.
  void require_id(ObjectId id) const;

  [[nodiscard]] bool is_present(ObjectId id) const noexcept { return states_[index_of(id)].present(); }
  [[nodiscard]] std::uint32_t flags_of(ObjectId id) const noexcept { return flags_[index_of(id)]; }
  /// What lists of image views, and of shadow maps, may hold at all: not what is hidden or a proxy.
  [[nodiscard]] const ObjectBits& listable() const noexcept { return listable_; }
  [[nodiscard]] const ObjectBits& listable_in_shadow() const noexcept { return listable_in_shadow_; }
  [[nodiscard]] std::span<const ObjectId> always_visible() const noexcept { return always_visible_; }
  /// The levels of detail of which this is one, ascending; empty where it stands for itself alone.
  [[nodiscard]] std::span<const ObjectId> group_of(ObjectId id) const noexcept;

 private:
  /// As the application has it; and what the cores have been told of it.
  struct State {
    bool in_use : 1 = false;  ///< not a spare id that waits
    bool hidden : 1 = false;
    bool empty : 1 = false;  ///< boxed, and its box has nothing in it: as good as hidden
    bool boxed : 1 = false;
    bool removed : 1 = false;  ///< since the last frame
    bool declared : 1 = false;
    bool told_absent : 1 = false;
    bool touched : 1 = false;
    bool moved : 1 = false;        ///< since the last frame, or its bounds changed
    bool newly_boxed : 1 = false;  ///< and the cores have not been told
    bool ever_moved : 1 = false;
    [[nodiscard]] bool present() const noexcept { return in_use && !hidden && !empty; }
  };

  void require_in_use(ObjectId id) const;
  State& touch(ObjectId id);
  void place(ObjectId id);
  void put_flags(ObjectId id, std::uint32_t flags);
  [[nodiscard]] bool may_be_reused(ObjectId id) const noexcept;
  void mind_lists(ObjectId id);
  void gather_groups();
  [[nodiscard]] MovedObject as_it_is(ObjectId id) const;
  [[nodiscard]] MovedObject as_in_scene(ObjectId id) const;

  std::shared_ptr<const SceneObjects> scene_;
  std::vector<Aabb> object_bounds_;
  std::vector<glm::dmat4x3> world_from_object_;
  std::vector<std::uint32_t> flags_;
  std::vector<State> states_;
  PlacedBounds bounds_;
  ObjectIds ids_;
  std::vector<ObjectId> touched_;
  ObjectBits listable_, listable_in_shadow_;
  std::vector<ObjectId> always_visible_;  ///< ascending
  std::vector<std::uint32_t> group_;      ///< by object, into group_begin_; empty without groups
  std::vector<std::uint32_t> group_begin_;
  std::vector<ObjectId> group_members_;
};

}  // namespace sightline
