#include "main_view/client/motion_blocks.hpp"

#include <array>
#include <cmath>
#include <limits>

#include <glm/common.hpp>

namespace sightline {
namespace {

constexpr float k_infinity = std::numeric_limits<float>::infinity();

/// No less than `value`, and by more than adding it to something rounds.
float rounded_up(double value) noexcept {
  return std::nextafter(static_cast<float>(value) * (1.0f + 0x1p-22f), k_infinity);
}

}  // namespace

std::span<const MotionKernel> motion_kernels() {
  static const auto k_kernels = std::to_array<MotionKernel>({
#if defined(__x86_64__)
    {"avx2", __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0,
     &avx2::k_motion_functions},
#endif
        {"plain", true, &plain::k_motion_functions},
  });
  return k_kernels;
}

const MotionFunctions& fastest_motion_functions() {
  for (const MotionKernel& kernel : motion_kernels()) {
    if (kernel.runs_here) return *kernel.functions;
  }
  return plain::k_motion_functions;
}

void MotionBlocks::add(const Aabb& object_bounds, const glm::dmat4x3& world_from_object) {
  const auto slot = static_cast<std::uint32_t>(size());
  if (lane(slot) == 0) blocks_.emplace_back();
  world_from_object_.push_back(world_from_object);
  object_bounds_.push_back(object_bounds);
  set_motion(slot, ObjectMotion(object_bounds, world_from_object));
}

ObjectMotion MotionBlocks::motion(std::uint32_t slot) const noexcept {
  const MotionBlock& block = block_of(slot);
  const std::size_t i = lane(slot);
  const auto vector = [i](const float(*rows)[k_block_lanes]) {
    return glm::dvec3(rows[0][i], rows[1][i], rows[2][i]);
  };
  ObjectMotion::Course course;
  course.time_s = block.time[i];
  course.step_s = block.step[i];
  course.last_way_m = block.last_way[i];
  course.velocity_m_per_s = vector(block.velocity);
  course.velocity_before_m_per_s = vector(block.before);
  course.between_s = block.between[i];
  for (int column = 0; column < 3; ++column) course.linear_per_s[column] = vector(block.change + 3 * column);
  return ObjectMotion(object_bounds_[slot], world_from_object_[slot], course);
}

void MotionBlocks::set_motion(std::uint32_t slot, const ObjectMotion& motion) noexcept {
  MotionBlock& block = blocks_[slot / k_block_lanes];
  const std::size_t i = lane(slot);
  world_from_object_[slot] = motion.world_from_object();
  object_bounds_[slot] = motion.object_bounds();
  const auto put = [i](const glm::dvec3& value, float(*rows)[k_block_lanes]) {
    for (int axis = 0; axis < 3; ++axis) rows[axis][i] = static_cast<float>(value[axis]);
  };
  const WorldBox bounds = motion.bounds();
  const ObjectMotion::Course& course = motion.course();
  for (int axis = 0; axis < 3; ++axis) {
    const double center = motion.center_m()[axis];
    block.center[axis][i] = center;
    block.reach[axis][i] = rounded_up(std::max(bounds.max[axis] - center, center - bounds.min[axis]));
  }
  block.time[i] = course.time_s;
  block.radius[i] = rounded_up(motion.radius_m());
  put(course.velocity_m_per_s, block.velocity);
  put(course.velocity_before_m_per_s, block.before);
  block.between[i] = static_cast<float>(course.between_s);
  block.step[i] = static_cast<float>(course.step_s);
  block.last_way[i] = static_cast<float>(course.last_way_m);
  const Aabb& box = motion.object_bounds();
  put(box.empty() ? glm::dvec3(0.0) : 0.5 * (glm::dvec3(box.max) - glm::dvec3(box.min)), block.half);
  for (int column = 0; column < 3; ++column) {
    put(motion.world_from_object()[column], block.linear + 3 * column);
    put(course.linear_per_s[column], block.change + 3 * column);
  }
}

void MotionBlocks::set_object_bounds(std::uint32_t slot, const Aabb& object_bounds) noexcept {
  ObjectMotion changed = motion(slot);
  changed.set_object_bounds(object_bounds);
  set_motion(slot, changed);
}

void MotionBlocks::stop(std::uint32_t slot) noexcept {
  MotionBlock& block = blocks_[slot / k_block_lanes];
  const std::size_t i = lane(slot);
  for (int axis = 0; axis < 3; ++axis) block.velocity[axis][i] = block.before[axis][i] = 0.0f;
  for (auto& row : block.change) row[i] = 0.0f;
}

void MotionSteps::add(std::uint32_t slot, const Aabb& object_bounds, const glm::dmat4x3& world_from_object,
                      bool stood) {
  const std::size_t block = slot / k_block_lanes, i = MotionBlocks::lane(slot);
  const std::uint32_t bit = 1u << i;
  if (block != block_ || (stage_.stepped & bit) != 0) {
    flush();
    block_ = block;
  }
  stage_.stepped |= bit;
  if (stood) stage_.stood |= bit;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) stage_.linear[3 * column + row][i] = world_from_object[column][row];
  }
  const bool empty = object_bounds.empty();
  for (int axis = 0; axis < 3; ++axis) {
    stage_.place[axis][i] = world_from_object[3][axis];
    stage_.low[axis][i] = empty ? 0.0f : object_bounds.min[axis];
    stage_.high[axis][i] = empty ? 0.0f : object_bounds.max[axis];
  }
  blocks_.world_from_object_[slot] = world_from_object;
}

void MotionSteps::flush() {
  if (stage_.stepped == 0) return;
  blocks_.functions_->step(blocks_.blocks_[block_], stage_, times_, covering_.rows(block_));
  stage_.stepped = stage_.stood = 0;
}

}  // namespace sightline
