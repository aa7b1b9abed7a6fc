#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace sightline {

/// So many objects are stepped and foretold together.
inline constexpr std::size_t k_block_lanes = 8;

/// A world box for each lane of a block, metres.
struct alignas(64) BoxRows {
  double min[3][k_block_lanes] = {};
  double max[3][k_block_lanes] = {};
};

/// ObjectMotion for as many objects, a row for each of its fields. Where an object is is double; all that is
/// relative to there is single, with what that rounds allowed for in `reach` and in what is foretold.
struct alignas(64) MotionBlock {
  double center[3][k_block_lanes] = {};  ///< of the bounds, world frame
  double time[k_block_lanes] = {};       ///< when it came to stand there
  double learnt_at[k_block_lanes] = {};  ///< `error` is as of this time
  float reach[3][k_block_lanes] = {};    ///< half the box around it, and what rounding moves
  float radius[k_block_lanes] = {};
  float velocity[3][k_block_lanes] = {};   ///< of the centre, mean of the last step
  float before[3][k_block_lanes] = {};     ///< of the step before; 0 where one of them has no direction
  float between[k_block_lanes] = {};       ///< the middles of the two steps, seconds
  float step[k_block_lanes] = {};          ///< the last one's, seconds
  float last_way[k_block_lanes] = {};      ///< of the last step, even if that was a jump
  float half[3][k_block_lanes] = {};       ///< of the bounds, the object's own frame
  float linear[9][k_block_lanes] = {};     ///< world_from_object, column after column
  float change[9][k_block_lanes] = {};     ///< of it, a second
  float error[k_block_lanes] = {};         ///< how far what was foretold was off
  std::int32_t since[k_block_lanes] = {};  ///< ForetoldBoxes columns from this one on are about it
};

/// New placements on their way into a block. Lanes that are not stepped may hold anything.
struct alignas(64) MotionStage {
  double linear[9][k_block_lanes] = {};
  double place[3][k_block_lanes] = {};
  float low[3][k_block_lanes] = {}, high[3][k_block_lanes] = {};  ///< the bounds, the object's own frame
  std::uint32_t stepped = 0;                                      ///< a bit a lane
  std::uint32_t stood = 0;                                        ///< likewise: it was at rest until now
};

/// The boxes that were foretold for now, of one block.
struct ForetoldRows {
  static constexpr std::size_t k_most = 8;
  std::size_t count = 0;
  const BoxRows* boxes[k_most] = {};
  std::int32_t numbers[k_most] = {};
};

/// The moment of a step, for all blocks.
struct StepTimes {
  double now_s = 0.0;
  double last_frame_s = 0.0;     ///< when the frame before was drawn
  std::int32_t next_number = 0;  ///< of the ForetoldBoxes column to come
};

/// The times that are foretold, for all blocks.
struct ForetellTimes {
  double now_s = 0.0;
  double from_s = 0.0, until_s = 0.0;
  double rest_s = 0.0;  ///< without a change for so long an object rests
};

/// What foretelling finds of a block, a bit a lane.
struct Foretold {
  std::uint32_t rested = 0;        ///< no change for long enough
  std::uint32_t turning_fast = 0;  ///< for ObjectMotion, which follows the arcs
};

/// How far an extrapolation may be off, beyond what was learnt: of the way to go, while little is known of
/// how well it is foretold; and of the object's size.
inline constexpr float k_least_error_of_way = 0.02f;
inline constexpr float k_least_error_of_size = 0.002f;
/// The next error may be larger than those before.
inline constexpr float k_error_margin = 1.25f;
/// An extrapolation's error is forgotten by half in this time, seconds.
inline constexpr float k_error_half_life_s = 1.0f;
/// No news for so many of its steps: it stands.
inline constexpr float k_steps_to_stop = 2.5f;

/// The same code for several instruction sets.
struct MotionFunctions {
  /// As ObjectMotion::step for the lanes in the stage, and then holds where each is against what was
  /// foretold.
  void (*step)(MotionBlock& block, const MotionStage& stage, const StepTimes& times,
               const ForetoldRows& foretold);
  /// As ObjectMotion::way_between for all lanes, `way`; `asked` is wider by what was learnt, and within what
  /// the wire takes. Of the lanes in `moving`, those without news stop, and learn from that.
  Foretold (*foretell)(MotionBlock& block, std::uint32_t moving, const ForetellTimes& times,
                       const ForetoldRows& foretold, BoxRows& way, BoxRows& asked);
};

namespace avx2 {
extern const MotionFunctions k_motion_functions;
}
namespace plain {
extern const MotionFunctions k_motion_functions;
}

struct MotionKernel {
  const char* name;
  bool runs_here;
  const MotionFunctions* functions;
};
/// Fastest first; the last runs everywhere. All give the same but for rounding.
[[nodiscard]] std::span<const MotionKernel> motion_kernels();
[[nodiscard]] const MotionFunctions& fastest_motion_functions();

}  // namespace sightline
