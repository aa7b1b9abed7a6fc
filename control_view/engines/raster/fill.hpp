// Included by the kernels only: SIGHTLINE_LANES names the namespace of their instruction set.
#pragma once

#include "control_view/engines/raster/target.hpp"

namespace sightline::raster::SIGHTLINE_LANES {

/// A triangle ready to be filled, in pixels of the whole image. A pixel is inside where
/// step_x * px + step_y * py + at_origin is not negative for all three edges. The values are whole 1/256ths
/// of the edge function, rounded down, with the fill rule already in them: exact, since the steps from pixel
/// to pixel are whole.
struct FillTriangle {
  std::int32_t step_x[3];
  std::int32_t step_y[3];
  std::int64_t at_origin[3];
  float depth_x, depth_y, depth_0;  ///< depth = min(most, fma(depth_y, py, fma(depth_x, px, depth_0)))
  float depth_most;
  int left, bottom, right, top;  ///< pixels, ends included, within the region
};

/// Lanes of a vector within a block: their column and row offsets.
struct LaneOffsets {
  Ints column = k_lanes > k_block ? iota() & all(k_block - 1) : iota();
  Ints row = k_lanes > k_block ? shift_right<3>(iota()) : all(0);
  Floats lane_f = to_float(iota());
  Floats column_f = to_float(column);
  Floats row_f = to_float(row);
};

/// All lanes of a vector, known when compiling.
struct EveryLane {};
inline Mask operator&(EveryLane, Mask a) {
  return a;
}

/// A triangle over the blocks of a target: which blocks it may show in, a vector of blocks at a time.
class BlockWalk {
 public:
  BlockWalk(const Target& target, const FillTriangle& t)
      : left_block((t.left - target.x0) / k_block),
        right_block((t.right - target.x0) / k_block),
        bottom_block((t.bottom - target.y0) / k_block),
        top_block((t.top - target.y0) / k_block),
        t_(t),
        x_(target.x0 + left_block * k_block),
        y_(target.y0 + bottom_block * k_block) {
    float margin[3];
    for (int i = 0; i < 3; ++i) {
      const std::int64_t across = std::int64_t{t.step_x[i]} * (k_block - 1);
      const std::int64_t along = std::int64_t{t.step_y[i]} * (k_block - 1);
      to_highest_[i] = (across > 0 ? across : 0) + (along > 0 ? along : 0);
      to_lowest_[i] = (across < 0 ? across : 0) + (along < 0 ? along : 0);
      row_[i] = t.at_origin[i] + std::int64_t{t.step_x[i]} * x_ + std::int64_t{t.step_y[i]} * y_;
      margin[i] = 4e-7f * (magnitude(row_[i]) + magnitude(std::int64_t{t.step_x[i]} * (t.right - x_)) +
                           magnitude(std::int64_t{t.step_y[i]} * (t.top - y_)) + magnitude(to_highest_[i]));
      highest_in_row_[i] = static_cast<float>(to_highest_[i]) + margin[i];
    }
    // An upper bound of the depth in a block: the plane where it is highest, and what rounding may add.
    const bool one_block = left_block == right_block && bottom_block == top_block;
    const auto low_x = static_cast<float>(one_block ? t.left - x_ : 0);
    const auto low_y = static_cast<float>(one_block ? t.bottom - y_ : 0);
    const auto high_x = static_cast<float>(one_block ? t.right - x_ : k_block - 1);
    const auto high_y = static_cast<float>(one_block ? t.top - y_ : k_block - 1);
    const float size = __builtin_fabsf(t.depth_0) +
                       __builtin_fabsf(t.depth_x) * static_cast<float>(t.right + k_block) +
                       __builtin_fabsf(t.depth_y) * static_cast<float>(t.top + k_block);
    to_nearest_ = t.depth_0 + t.depth_x * (t.depth_x > 0.0f ? high_x : low_x) +
                  t.depth_y * (t.depth_y > 0.0f ? high_y : low_y) + 1e-6f * size;
  }

  void next_row() {
    for (int i = 0; i < 3; ++i) row_[i] += std::int64_t{t_.step_y[i]} * k_block;
    y_ += k_block;
  }

  /// Of the k_lanes blocks from `block` of the row on: bit b is set unless block b certainly shows nothing of
  /// the triangle. Errs towards set.
  [[nodiscard]] unsigned may_show(const Target& target, int by, int bx, Floats lane) const {
    const auto along_row = static_cast<float>(bx - left_block);
    const Floats blocks = all(along_row) + lane;
    Mask inside = all(-1) > all(-2);
    for (int i = 0; i < 3; ++i) {
      const Floats highest = all(static_cast<float>(row_[i]) + highest_in_row_[i]) +
                             all(static_cast<float>(t_.step_x[i]) * k_block) * blocks;
      inside = inside & !(all(0.0f) > highest);
    }
    const Floats x = all(static_cast<float>(x_)) + blocks * all(static_cast<float>(k_block));
    const Floats nearest = all(to_nearest_ + t_.depth_y * static_cast<float>(y_)) + all(t_.depth_x) * x;
    inside = inside & !(load(target.far_from(by * target.blocks_x + bx)) > nearest);
    const int left = right_block - bx + 1;
    return bits(inside) & (left < k_lanes ? (1u << left) - 1u : (1u << k_lanes) - 1u);
  }

  /// Goes to one block of the row.
  void enter(int bx) {
    for (int i = 0; i < 3; ++i) at_[i] = row_[i] + std::int64_t{t_.step_x[i]} * ((bx - left_block) * k_block);
  }
  [[nodiscard]] bool outside() const {
    return ((at_[0] + to_highest_[0]) | (at_[1] + to_highest_[1]) | (at_[2] + to_highest_[2])) < 0;
  }
  [[nodiscard]] bool covers() const {
    return ((at_[0] + to_lowest_[0]) | (at_[1] + to_lowest_[1]) | (at_[2] + to_lowest_[2])) >= 0;
  }
  /// At the first pixel of a block that is not outside: fits, since steps within a block are small beside it.
  [[nodiscard]] std::int32_t edge(int i) const {
    constexpr std::int64_t k_limit = 1 << 29;
    return static_cast<std::int32_t>(at_[i] < k_limit ? at_[i] : k_limit);
  }
  /// NaN where the plane is not finite.
  [[nodiscard]] float nearest(int x, int y) const {
    return to_nearest_ + t_.depth_x * static_cast<float>(x) + t_.depth_y * static_cast<float>(y);
  }

  const int left_block, right_block, bottom_block, top_block;

 private:
  static float magnitude(std::int64_t a) { return __builtin_fabsf(static_cast<float>(a)); }

  const FillTriangle& t_;
  int x_, y_;                                  ///< first pixel of the row
  std::int64_t row_[3];                        ///< edges there
  std::int64_t at_[3] = {};                    ///< at the first pixel of the block at hand
  std::int64_t to_highest_[3], to_lowest_[3];  ///< from a block's first pixel to the ends of its range
  float highest_in_row_[3];                    ///< the same, and what rounding may take away
  float to_nearest_;
};

/// The pixels of one block, a vector at a time: visit(first pixel in the target's arrays, mask of those
/// inside, their depths). Returns whether any call changed the image.
template <class Visit>
inline bool visit_block(const Target& target, const FillTriangle& t, const BlockWalk& walk,
                        const Ints lane_edge[3], const LaneOffsets& lanes, int bx, int by, Visit&& visit) {
  const int x = target.x0 + bx * k_block, y = target.y0 + by * k_block;
  const Floats depth_x = all(t.depth_x), depth_y = all(t.depth_y), depth_0 = all(t.depth_0),
               most = all(t.depth_most);
  // Vectors shorter than a row take two columns in turn, longer ones several rows at once.
  constexpr int k_vectors_a_row = k_lanes < k_block ? k_block / k_lanes : 1;
  constexpr int k_rows_a_vector = k_lanes > k_block ? k_lanes / k_block : 1;
  const Floats columns = all(static_cast<float>(x)) + lanes.column_f;
  Floats along_row[k_vectors_a_row];
  for (int part = 0; part < k_vectors_a_row; ++part) {
    along_row[part] = fused_multiply_add(depth_x, columns + all(static_cast<float>(part * k_lanes)), depth_0);
  }
  const Floats next_row = all(static_cast<float>(k_rows_a_vector));
  const int first_pixel = (by * target.blocks_x + bx) * k_block_pixels;
  bool changed = false;
  // Rounding at the near plane may lift a depth above 1.
  if (walk.covers()) {
    Floats py = all(static_cast<float>(y)) + lanes.row_f;
    for (int row = 0; row < k_block; row += k_rows_a_vector, py = py + next_row) {
      for (int part = 0; part < k_vectors_a_row; ++part) {
        const Floats depth = min(fused_multiply_add(depth_y, py, along_row[part]), most);
        changed |= visit(first_pixel + row * k_block + part * k_lanes, EveryLane{}, depth);
      }
    }
    return changed;
  }
  const int first_row = (t.bottom > y ? t.bottom - y : 0) / k_rows_a_vector * k_rows_a_vector;
  const int last_row = t.top - y < k_block - 1 ? t.top - y : k_block - 1;
  Ints edge[3], edge_step[3], part_step[3];
  for (int e = 0; e < 3; ++e) {
    edge[e] = lane_edge[e] + all(walk.edge(e) + t.step_y[e] * first_row);
    edge_step[e] = all(t.step_y[e] * k_rows_a_vector);
    part_step[e] = all(t.step_x[e] * k_lanes);
  }
  Floats py = all(static_cast<float>(y + first_row)) + lanes.row_f;
  for (int row = first_row; row <= last_row; row += k_rows_a_vector, py = py + next_row) {
    for (int part = 0; part < k_vectors_a_row; ++part) {
      const Ints edges = part == 0
                             ? edge[0] | edge[1] | edge[2]
                             : (edge[0] + part_step[0]) | (edge[1] + part_step[1]) | (edge[2] + part_step[2]);
      const Floats depth = min(fused_multiply_add(depth_y, py, along_row[part]), most);
      changed |= visit(first_pixel + row * k_block + part * k_lanes, edges > all(-1), depth);
    }
    for (int e = 0; e < 3; ++e) edge[e] = edge[e] + edge_step[e];
  }
  return changed;
}

template <class Visit>
inline void for_each_covered(Target& target, const FillTriangle& t, const LaneOffsets& lanes, Visit&& visit) {
  BlockWalk walk(target, t);
  Ints lane_edge[3];
  for (int i = 0; i < 3; ++i) {
    lane_edge[i] = all(t.step_x[i]) * lanes.column;
    if constexpr (k_lanes > k_block) lane_edge[i] = lane_edge[i] + all(t.step_y[i]) * lanes.row;
  }
  for (int by = walk.bottom_block; by <= walk.top_block; ++by, walk.next_row()) {
    for (int first = walk.left_block; first <= walk.right_block; first += k_lanes) {
      for (unsigned blocks = walk.may_show(target, by, first, lanes.lane_f); blocks != 0;
           blocks &= blocks - 1) {
        const int bx = first + __builtin_ctz(blocks);
        walk.enter(bx);
        if (walk.outside()) continue;
        const int block = by * target.blocks_x + bx;
        if (target.hides_block(block, walk.nearest(target.x0 + bx * k_block, target.y0 + by * k_block)))
          continue;
        target.open(block);
        if (visit_block(target, t, walk, lane_edge, lanes, bx, by, visit)) target.mark_dirty(block);
      }
    }
  }
}

/// Those of `inside` that a fragment of `rank` wins: nearer, or as near and earlier in the drawing order.
template <class Inside>
inline Mask wins(const Target& target, int pixel, Inside inside, Floats depth, Ints rank) {
  const Floats old_depth = load(target.depth + pixel);
  const Mask nearer = depth > old_depth;
  const Mask earlier = (depth == old_depth) & (load(target.rank + pixel) > rank);
  return inside & (nearer | earlier);
}

inline void fill_opaque(Target& target, const FillTriangle& triangle, const LaneOffsets& lanes,
                        std::int32_t rank) {
  const Ints ranks = all(rank);
  for_each_covered(target, triangle, lanes, [&](int pixel, auto inside, Floats depth) {
    const Mask won = wins(target, pixel, inside, depth, ranks);
    if (bits(won) == 0) return false;
    store(target.depth + pixel, select(won, depth, load(target.depth + pixel)));
    store(target.rank + pixel, select(won, ranks, load(target.rank + pixel)));
    return true;
  });
}

/// `passes(px, py)` is the alpha test at a pixel of the whole image.
template <class AlphaTest>
inline void fill_masked(Target& target, const FillTriangle& triangle, const LaneOffsets& lanes,
                        std::int32_t rank, AlphaTest&& passes) {
  const Ints ranks = all(rank);
  for_each_covered(target, triangle, lanes, [&](int pixel, auto inside, Floats depth) {
    unsigned candidates = bits(wins(target, pixel, inside, depth, ranks));
    if (candidates == 0) return false;
    float depths[k_lanes];
    store(depths, depth);
    bool changed = false;
    for (; candidates != 0; candidates &= candidates - 1) {
      const int lane = __builtin_ctz(candidates);
      const int at = pixel + lane;
      const int block = at / k_block_pixels, in_block = at % k_block_pixels;
      const int px = target.x0 + block % target.blocks_x * k_block + in_block % k_block;
      const int py = target.y0 + block / target.blocks_x * k_block + in_block / k_block;
      if (!passes(px, py)) continue;
      target.depth[at] = depths[lane];
      target.rank[at] = rank;
      changed = true;
    }
    return changed;
  });
}

/// Counts the pixels with a fragment in front of the opaque depth that do not carry `mark` yet, and marks
/// them.
inline std::uint32_t fill_blended(Target& target, const FillTriangle& triangle, const LaneOffsets& lanes,
                                  std::int32_t mark) {
  std::uint32_t pixels = 0;
  const Ints marks = all(mark);
  for_each_covered(target, triangle, lanes, [&](int pixel, auto inside, Floats depth) {
    const Ints old = load(target.blended_mark + pixel);
    const Mask fresh = inside & ((depth > load(target.depth + pixel)) & !(old == marks));
    const unsigned count = bits(fresh);
    if (count == 0) return false;
    pixels += static_cast<std::uint32_t>(__builtin_popcount(count));
    store(target.blended_mark + pixel, select(fresh, marks, old));
    return false;
  });
  return pixels;
}

/// Blocks of a target, ends included; none while right < left.
struct BlockRectangle {
  int left = 1, bottom = 1, right = 0, top = 0;

  [[nodiscard]] bool empty() const { return right < left; }
  [[nodiscard]] int area() const { return empty() ? 0 : (right - left + 1) * (top - bottom + 1); }
  void add(int bx, int by) {
    if (empty()) {
      left = right = bx;
      bottom = top = by;
      return;
    }
    if (bx < left) left = bx;
    if (bx > right) right = bx;
    if (by < bottom) bottom = by;
    if (by > top) top = by;
  }
};

/// Adds the blocks in which the triangle lies in front of the image somewhere.
inline void find_in_front(Target& target, const FillTriangle& triangle, const LaneOffsets& lanes,
                          BlockRectangle& found) {
  for_each_covered(target, triangle, lanes, [&](int pixel, auto inside, Floats depth) {
    if (bits(inside & (depth > load(target.depth + pixel))) == 0) return false;
    const int block = pixel / k_block_pixels;
    found.add(block % target.blocks_x, block / target.blocks_x);
    return false;
  });
}

}  // namespace sightline::raster::SIGHTLINE_LANES
