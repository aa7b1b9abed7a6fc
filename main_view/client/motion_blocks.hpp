#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/mat4x3.hpp>

#include "common/bounds.hpp"
#include "main_view/client/foretold_boxes.hpp"
#include "main_view/client/motion_block.hpp"
#include "main_view/client/object_motion.hpp"

namespace sightline {

/// Many ObjectMotions, by slot: stepped and foretold by blocks, at a few nanoseconds each.
///
/// What is foretold holds what ObjectMotion would foretell, and little more: speeds are kept in single
/// precision, and every box is wider by what that rounds.
class MotionBlocks {
 public:
  explicit MotionBlocks(const MotionFunctions& functions = fastest_motion_functions())
      : functions_(&functions) {}

  [[nodiscard]] std::size_t size() const noexcept { return world_from_object_.size(); }
  [[nodiscard]] std::size_t block_count() const noexcept { return blocks_.size(); }
  /// Of the next slot, at rest.
  void add(const Aabb& object_bounds, const glm::dmat4x3& world_from_object);

  [[nodiscard]] const glm::dmat4x3& world_from_object(std::uint32_t slot) const noexcept {
    return world_from_object_[slot];
  }
  [[nodiscard]] const Aabb& object_bounds(std::uint32_t slot) const noexcept { return object_bounds_[slot]; }
  /// When it came to stand where it is.
  [[nodiscard]] double changed_s(std::uint32_t slot) const noexcept {
    return block_of(slot).time[lane(slot)];
  }
  /// As ObjectMotion::bounds, or a little larger.
  [[nodiscard]] WorldBox bounds(std::uint32_t slot) const noexcept {
    const MotionBlock& block = block_of(slot);
    const std::size_t i = lane(slot);
    const glm::dvec3 center(block.center[0][i], block.center[1][i], block.center[2][i]);
    const glm::dvec3 reach(block.reach[0][i], block.reach[1][i], block.reach[2][i]);
    return {center - reach, center + reach};
  }
  /// The same as an ObjectMotion.
  [[nodiscard]] ObjectMotion motion(std::uint32_t slot) const noexcept;
  void set_motion(std::uint32_t slot, const ObjectMotion& motion) noexcept;
  void set_object_bounds(std::uint32_t slot, const Aabb& object_bounds) noexcept;
  void stop(std::uint32_t slot) noexcept;

  /// Metres that what was foretold of it was off.
  [[nodiscard]] double error_m(std::uint32_t slot) const noexcept { return block_of(slot).error[lane(slot)]; }
  /// Only what was foretold under this number or later is about it.
  void forget_foretold_before(std::uint32_t slot, std::int32_t number) noexcept {
    blocks_[slot / k_block_lanes].since[lane(slot)] = number;
  }

  [[nodiscard]] Foretold foretell(std::size_t block, std::uint32_t moving, const ForetellTimes& times,
                                  const ForetoldRows& foretold, BoxRows& way, BoxRows& asked) {
    return functions_->foretell(blocks_[block], moving, times, foretold, way, asked);
  }

  static std::size_t lane(std::uint32_t slot) noexcept { return slot % k_block_lanes; }

 private:
  friend class MotionSteps;
  [[nodiscard]] const MotionBlock& block_of(std::uint32_t slot) const noexcept {
    return blocks_[slot / k_block_lanes];
  }

  const MotionFunctions* functions_;
  std::vector<MotionBlock> blocks_;
  std::vector<glm::dmat4x3> world_from_object_;
  std::vector<Aabb> object_bounds_;
};

/// The steps of one moment, gathered by blocks. Blocks may be added meanwhile.
class MotionSteps {
 public:
  MotionSteps(MotionBlocks& blocks, const StepTimes& times, const ForetoldBoxes::Covering& covering)
      : blocks_(blocks), times_(times), covering_(covering) {}
  ~MotionSteps() { flush(); }
  MotionSteps(const MotionSteps&) = delete;
  MotionSteps& operator=(const MotionSteps&) = delete;

  /// The object stands there; `stood`: it was at rest until now.
  void add(std::uint32_t slot, const Aabb& object_bounds, const glm::dmat4x3& world_from_object, bool stood);
  void flush();

 private:
  MotionBlocks& blocks_;
  StepTimes times_;
  const ForetoldBoxes::Covering& covering_;
  std::size_t block_ = 0;
  MotionStage stage_;
};

}  // namespace sightline
