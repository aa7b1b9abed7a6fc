// The motion of a block of objects, in the lanes of SIGHTLINE_LANES. Included by motion_kernel_*.cpp alone;
// whatever is inline here is of that namespace, since each of these files is compiled for another machine.
#pragma once

#include "main_view/client/motion_block.hpp"
#include SIGHTLINE_LANES_HEADER

namespace sightline::SIGHTLINE_LANES {

inline constexpr float k_least_step_s = 1e-6f;
inline constexpr float k_jump_m = 0.5f;
inline constexpr float k_jump_speed_factor = 4.0f;
inline constexpr float k_least_way_m = 1e-5f;
/// Square of the turn that is taken for straight ways.
inline constexpr float k_little_turn_squared = 0.25f * 0.25f;
/// Single precision of the object's own shape, here and where it is drawn.
inline constexpr float k_rounding_of_size = 0x1p-19f;
/// Double precision of where it is.
inline constexpr float k_rounding_of_place = 2e-12f;
/// Single precision of speeds, relative to what they are differences of.
inline constexpr float k_rounding_of_speed = 0x1p-21f;
/// As far as the wire goes.
inline constexpr double k_wire_limit_m = 1e12;

struct Vectors {
  Floats x, y, z;
};
inline Vectors load3(const float (*rows)[k_block_lanes], std::size_t at) {
  return {load(rows[0] + at), load(rows[1] + at), load(rows[2] + at)};
}
inline void store3(float (*rows)[k_block_lanes], std::size_t at, const Vectors& v) {
  store(rows[0] + at, v.x);
  store(rows[1] + at, v.y);
  store(rows[2] + at, v.z);
}
inline Vectors operator+(const Vectors& a, const Vectors& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vectors operator-(const Vectors& a, const Vectors& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vectors operator*(const Vectors& a, Floats s) {
  return {a.x * s, a.y * s, a.z * s};
}
inline Floats dot(const Vectors& a, const Vectors& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vectors magnitude(const Vectors& a) {
  return {magnitude(a.x), magnitude(a.y), magnitude(a.z)};
}
inline Vectors larger(const Vectors& a, const Vectors& b) {
  return {larger(a.x, b.x), larger(a.y, b.y), larger(a.z, b.z)};
}
inline Vectors smaller(const Vectors& a, const Vectors& b) {
  return {smaller(a.x, b.x), smaller(a.y, b.y), smaller(a.z, b.z)};
}
inline Vectors select(Mask mask, const Vectors& yes, const Vectors& no) {
  return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}
inline Vectors all3(Floats a) {
  return {a, a, a};
}
inline Floats largest_of(const Vectors& a) {
  return larger(larger(a.x, a.y), a.z);
}

struct Centers {
  Doubles x, y, z;
};
inline Centers load3(const double (*rows)[k_block_lanes], std::size_t at) {
  return {load(rows[0] + at), load(rows[1] + at), load(rows[2] + at)};
}
inline Vectors to_floats(const Centers& a) {
  return {to_floats(a.x), to_floats(a.y), to_floats(a.z)};
}

/// What an error keeps after so many half lives: (1 + x/8)^-8, never less than 2^-passed.
inline Floats kept_after(Floats passed_s) {
  const Floats eighth = all(1.0f) + passed_s * all(0.0866434f / k_error_half_life_s);
  const Floats square = eighth * eighth, fourth = square * square;
  return all(1.0f) / (fourth * fourth);
}

/// Holds where the lanes in `mask` are against what was foretold for now.
inline void learn(MotionBlock& block, std::size_t at, Mask mask, double now_s, const Centers& center,
                  const Vectors& reach, const ForetoldRows& foretold) {
  const Doubles old_at = load(block.learnt_at + at);
  const Floats old_error = load(block.error + at);
  Floats error = old_error * kept_after(larger(to_floats(all(now_s) - old_at), all(0.0f)));
  const Centers out{to_doubles(reach.x), to_doubles(reach.y), to_doubles(reach.z)};
  const Doubles low[] = {center.x - out.x, center.y - out.y, center.z - out.z};
  const Doubles high[] = {center.x + out.x, center.y + out.y, center.z + out.z};
  for (std::size_t i = 0; i < foretold.count; ++i) {
    const BoxRows& boxes = *foretold.boxes[i];
    Floats excess = all(0.0f);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      excess = larger(to_floats(load(boxes.min[axis] + at) - low[axis]), excess);
      excess = larger(to_floats(high[axis] - load(boxes.max[axis] + at)), excess);
    }
    error = select(reached(block.since + at, foretold.numbers[i]), larger(excess, error), error);
  }
  store(block.error + at, select(mask, error, old_error));
  store(block.learnt_at + at, select(mask, all(now_s), old_at));
}

/// Where the staged placements put the bounds.
struct Measured {
  Centers center;
  Vectors half, edge[3], reach;
  Floats radius;
};

inline Measured measured(const MotionStage& stage, std::size_t at) {
  Measured now;
  Doubles center[3] = {load(stage.place[0] + at), load(stage.place[1] + at), load(stage.place[2] + at)};
  Floats half[3];
  Vectors size = all3(all(0.0f));
  for (std::size_t column = 0; column < 3; ++column) {
    const Doubles low = to_doubles(load(stage.low[column] + at)),
                  high = to_doubles(load(stage.high[column] + at));
    const Doubles middle = (low + high) * all(0.5);
    half[column] = to_floats((high - low) * all(0.5));
    Floats edge[3];
    for (std::size_t row = 0; row < 3; ++row) {
      const Doubles entry = load(stage.linear[3 * column + row] + at);
      center[row] = center[row] + entry * middle;
      edge[row] = to_floats(entry);
    }
    now.edge[column] = {edge[0], edge[1], edge[2]};
    size = size + magnitude(now.edge[column]) * half[column];
  }
  now.center = {center[0], center[1], center[2]};
  now.half = {half[0], half[1], half[2]};
  now.radius = root(dot(size, size));
  const Floats farthest = largest_of(magnitude(to_floats(now.center)) + size);
  now.reach = size + all3(now.radius * all(k_rounding_of_size) + farthest * all(k_rounding_of_place));
  return now;
}

inline void step_lanes(MotionBlock& block, const MotionStage& stage, const StepTimes& times,
                       const ForetoldRows& foretold, std::size_t at) {
  const Mask stepped = mask_of(stage.stepped >> at);
  const Floats zero = all(0.0f);
  const Measured now = measured(stage, at);
  const Centers old_center = load3(block.center, at);
  const Vectors way = to_floats(
      Centers{now.center.x - old_center.x, now.center.y - old_center.y, now.center.z - old_center.z});
  const Floats way_m = root(dot(way, way));

  // What stood until now stood in the frame before as well.
  const Doubles old_time = load(block.time + at);
  const Floats last_step_s = load(block.step + at), last_way_m = load(block.last_way + at);
  const Floats passed_s = to_floats(all(times.now_s) - old_time);
  const Mask stood = either(mask_of(stage.stood >> at), above(passed_s, all(k_steps_to_stop) * last_step_s));
  const Floats since_frame_s = to_floats(all(times.now_s) - all(times.last_frame_s));
  const Floats step_s = larger(select(stood, smaller(since_frame_s, passed_s), passed_s), zero);

  const Floats last_speed = select(above(last_step_s, all(k_least_step_s)), last_way_m / last_step_s, zero);
  const Floats longest = all(k_jump_m) + all(k_jump_speed_factor) * last_speed * step_s;
  const Mask went_on = both(above(step_s, all(k_least_step_s)),
                            either(at_most(way_m, all(k_jump_m)), at_most(way_m, longest)));
  const Floats per_s = all(1.0f) / step_s;
  const Vectors old_velocity = load3(block.velocity, at);
  const Mask both_have_directions =
      both(went_on, both(above(way_m, all(k_least_way_m)), above(last_way_m, all(k_least_way_m))));
  store3(block.velocity, at, select(stepped, select(went_on, way * per_s, all3(zero)), old_velocity));
  store3(block.before, at,
         select(stepped, select(both_have_directions, old_velocity, all3(zero)), load3(block.before, at)));
  for (std::size_t column = 0; column < 3; ++column) {
    const Vectors old = load3(block.linear + 3 * column, at);
    const Vectors change = select(went_on, (now.edge[column] - old) * per_s, all3(zero));
    store3(block.change + 3 * column, at, select(stepped, change, load3(block.change + 3 * column, at)));
    store3(block.linear + 3 * column, at, select(stepped, now.edge[column], old));
  }
  store(block.between + at, select(stepped, all(0.5f) * (step_s + last_step_s), load(block.between + at)));
  store(block.step + at, select(stepped, step_s, last_step_s));
  store(block.last_way + at, select(stepped, way_m, last_way_m));
  store(block.radius + at, select(stepped, now.radius, load(block.radius + at)));
  store3(block.half, at, select(stepped, now.half, load3(block.half, at)));
  store3(block.reach, at, select(stepped, now.reach, load3(block.reach, at)));
  store(block.center[0] + at, select(stepped, now.center.x, old_center.x));
  store(block.center[1] + at, select(stepped, now.center.y, old_center.y));
  store(block.center[2] + at, select(stepped, now.center.z, old_center.z));
  store(block.time + at, select(stepped, all(times.now_s), old_time));
  set_where(both(stepped, inverse(went_on)), times.next_number, block.since + at);
  learn(block, at, stepped, times.now_s, now.center, now.reach, foretold);
}

/// Square of how fast it turns, see ObjectMotion::turn_squared.
inline Floats turn_squared(const Vectors (&edges)[3], const Vectors (&changes)[3]) {
  Floats fastest = all(0.0f);
  for (int axis = 0; axis < 3; ++axis) {
    const Floats change = dot(changes[axis], changes[axis]), length = dot(edges[axis], edges[axis]);
    fastest = select(above(change, fastest * length), change / length, fastest);
  }
  return all(1.51f) * fastest;
}

inline void stop(MotionBlock& block, std::size_t at, Mask mask) {
  const Vectors none = all3(all(0.0f));
  store3(block.velocity, at, select(mask, none, load3(block.velocity, at)));
  store3(block.before, at, select(mask, none, load3(block.before, at)));
  for (std::size_t i = 0; i < 9; i += 3)
    store3(block.change + i, at, select(mask, none, load3(block.change + i, at)));
}

inline Foretold foretell_lanes(MotionBlock& block, std::uint32_t moving, const ForetellTimes& times,
                               const ForetoldRows& foretold, BoxRows& way, BoxRows& asked, std::size_t at) {
  const Floats zero = all(0.0f);
  const Centers center = load3(block.center, at);
  const Doubles time = load(block.time + at);
  const Vectors reach = load3(block.reach, at);
  const Floats step_s = load(block.step + at), radius = load(block.radius + at);
  Foretold found;

  const Floats quiet_s = to_floats(all(times.now_s) - time);
  const Mask quiet = both(mask_of(moving >> at), above(quiet_s, zero));
  if (bits_of(quiet) != 0) {
    stop(block, at, both(quiet, above(quiet_s, all(k_steps_to_stop) * step_s)));
    learn(block, at, quiet, times.now_s, center, reach, foretold);
    found.rested = bits_of(both(quiet, at_most(all(static_cast<float>(times.rest_s)), quiet_s))) << at;
  }

  const Floats begin_s = larger(to_floats(all(times.from_s) - time), zero),
               end_s = larger(to_floats(all(times.until_s) - time), begin_s);
  const Vectors velocity = load3(block.velocity, at), before = load3(block.before, at);
  const Floats squared = dot(velocity, velocity);
  const Vectors change_of_speed = (velocity - before) * (all(1.0f) / load(block.between + at));
  const Mask bends = above(dot(velocity, before), zero);
  // Acceleration at right angles to the velocity.
  const Vectors across =
      select(bends, change_of_speed - velocity * (dot(change_of_speed, velocity) / squared), all3(zero));
  const Floats across_squared = dot(across, across);
  const Floats bend_squared = select(bends, across_squared / squared, zero);

  const Vectors half = load3(block.half, at);
  const Vectors edges[] = {load3(block.linear, at), load3(block.linear + 3, at), load3(block.linear + 6, at)};
  const Vectors changes[] = {load3(block.change, at), load3(block.change + 3, at),
                             load3(block.change + 6, at)};
  const Floats turn = turn_squared(edges, changes);
  const Floats speed = root(squared), point_speed = speed + radius * root(turn);
  const Mask little = at_most(larger(turn, bend_squared) * end_s * end_s, all(k_little_turn_squared));
  found.turning_fast = bits_of(inverse(little)) << at;

  // As ObjectMotion::turning_little. The reach has the size in it, rounded outwards: what is foretold of the
  // size is held against that.
  const Floats halves[] = {half.x, half.y, half.z};
  Vectors size_at_begin = all3(zero), size_at_end = all3(zero);
  for (int axis = 0; axis < 3; ++axis) {
    size_at_begin = size_at_begin + magnitude(edges[axis] + changes[axis] * begin_s) * halves[axis];
    size_at_end = size_at_end + magnitude(edges[axis] + changes[axis] * end_s) * halves[axis];
  }
  const Floats passed_s = end_s - begin_s, reach_s = end_s + step_s;
  const Floats half_squared_turn = all(0.5f) * radius * turn * end_s * reach_s;
  const Floats rise_of_way = all(0.125f) * passed_s * passed_s * root(across_squared);
  const Floats rise_of_arc =
      select(bends, end_s * reach_s * reach_s * all(1.0f / 6.0f) * across_squared / speed, zero);
  const Floats steps = select(above(step_s, all(k_least_step_s)), end_s / step_s, zero);
  const Floats farthest = largest_of(magnitude(to_floats(center)) + size_at_end);
  const Floats rounding = radius * all(k_rounding_of_size) +
                          (farthest + speed * end_s) * all(k_rounding_of_place) +
                          all(k_rounding_of_speed) * (all(1.0f) + steps) * (radius + speed * end_s);
  const Vectors rise = all3(half_squared_turn + rise_of_way + rise_of_arc + rounding);
  const Vectors speed_at_end = velocity + across * (all(0.5f) * step_s);  // the mean is that of the middle
  const Vectors at_begin = (speed_at_end + across * (all(0.5f) * begin_s)) * begin_s;
  const Vectors at_end = (speed_at_end + across * (all(0.5f) * end_s)) * end_s;
  const Vectors low = smaller(at_begin - size_at_begin, at_end - size_at_end) - rise;
  const Vectors high = larger(at_begin + size_at_begin, at_end + size_at_end) + rise;

  const Floats ahead_s = all(static_cast<float>(times.until_s - times.now_s));
  const Floats least_error = all(k_least_error_of_way) * point_speed * ahead_s +
                             all(2.0f * k_least_error_of_size) * root(dot(reach, reach));
  const Vectors error = all3(all(k_error_margin) * load(block.error + at) + least_error);
  // Infinite and NaN alike: numbers that no scene has. Then it may be anywhere.
  const Vectors asked_low = low - error, asked_high = high + error;
  const Vectors widest = larger(magnitude(asked_low), magnitude(asked_high));
  const Floats sum = (at_begin.x + at_begin.y + at_begin.z + at_end.x + at_end.y + at_end.z) * zero +
                     (widest.x + widest.y + widest.z) * zero + (rise.x + error.x) * zero;
  const Mask finite = at_most(magnitude(sum), zero);
  const Doubles centers[] = {center.x, center.y, center.z};
  const Floats lows[] = {low.x, low.y, low.z}, highs[] = {high.x, high.y, high.z};
  const Floats asked_lows[] = {asked_low.x, asked_low.y, asked_low.z},
               asked_highs[] = {asked_high.x, asked_high.y, asked_high.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    store(way.min[axis] + at, centers[axis] + to_doubles(lows[axis]));
    store(way.max[axis] + at, centers[axis] + to_doubles(highs[axis]));
    store(asked.min[axis] + at,
          select(finite, within(centers[axis] + to_doubles(asked_lows[axis]), k_wire_limit_m),
                 all(-k_wire_limit_m)));
    store(asked.max[axis] + at,
          select(finite, within(centers[axis] + to_doubles(asked_highs[axis]), k_wire_limit_m),
                 all(k_wire_limit_m)));
  }
  return found;
}

inline void step(MotionBlock& block, const MotionStage& stage, const StepTimes& times,
                 const ForetoldRows& foretold) {
  for (std::size_t at = 0; at < k_block_lanes; at += k_lanes) {
    if (k_lanes > 1 || (stage.stepped >> at & 1u) != 0) step_lanes(block, stage, times, foretold, at);
  }
}

inline Foretold foretell(MotionBlock& block, std::uint32_t moving, const ForetellTimes& times,
                         const ForetoldRows& foretold, BoxRows& way, BoxRows& asked) {
  Foretold all_found;
  for (std::size_t at = 0; at < k_block_lanes; at += k_lanes) {
    const Foretold found = foretell_lanes(block, moving, times, foretold, way, asked, at);
    all_found.rested |= found.rested;
    all_found.turning_fast |= found.turning_fast;
  }
  return all_found;
}

}  // namespace sightline::SIGHTLINE_LANES
