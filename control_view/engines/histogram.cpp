#include "control_view/engines/histogram.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include <immintrin.h>

namespace sightline {

void CountAccumulator::take(PixelCounts& counts) {
  counts.clear();
  std::sort(touched_.begin(), touched_.end());
  for (const ObjectId id : touched_) {
    counts.ids.push_back(id);
    counts.pixels.push_back(std::exchange(pixels_[index_of(id)], 0));
    if (says_where_) counts.extents.push_back(extents_[index_of(id)]);
  }
  says_where_ = false;
  touched_.clear();
}

namespace {

void add_run(ItemCode code, std::size_t length, CountAccumulator& sum) {
  if (code != k_background_code) sum.add(object_of(code), static_cast<std::uint32_t>(length));
}

void add_plain(std::span<const ItemCode> codes, CountAccumulator& sum) {
  for (const ItemCode code : codes) add_run(code, 1, sum);
}

/// Adds the runs that end at the set bits of `ends`: bit b says that pixel first + b differs from the one
/// before. `run_start` is where the current run began, and moves on.
inline void add_ended_runs(std::uint64_t ends, std::size_t first, const ItemCode* codes,
                           std::size_t& run_start, CountAccumulator& sum) {
  while (ends != 0) {
    const std::size_t end = first + static_cast<std::size_t>(std::countr_zero(ends));
    add_run(codes[run_start], end - run_start, sum);
    run_start = end;
    ends &= ends - 1;
  }
}

/// Of 64 pixels, so many ends of runs that adding pixel by pixel is quicker: finding each end and adding its
/// run costs about half as much again as adding a pixel.
constexpr int k_dense_ends = 44;

/// A block of 64 pixels from `first` on, by runs or, where it is mostly noise, by pixels.
inline __attribute__((always_inline)) void add_block(std::uint64_t ends, std::size_t first,
                                                     const ItemCode* codes, std::size_t& run_start,
                                                     CountAccumulator& sum) {
  if (std::popcount(ends) < k_dense_ends) {
    add_ended_runs(ends, first, codes, run_start, sum);
    return;
  }
  add_run(codes[run_start], first - run_start, sum);
  for (std::size_t i = first; i < first + 64; ++i) add_run(codes[i], 1, sum);
  run_start = first + 64;  // an empty run, should the next pixel differ
}

/// Runs in what the vector loop left over, and the last run.
void add_tail(std::span<const ItemCode> codes, std::size_t from, std::size_t run_start,
              CountAccumulator& sum) {
  if (run_start >= codes.size()) return;
  for (std::size_t i = from; i < codes.size(); ++i) {
    if (codes[i] == codes[i - 1]) continue;
    add_run(codes[run_start], i - run_start, sum);
    run_start = i;
  }
  add_run(codes[run_start], codes.size() - run_start, sum);
}

constexpr std::size_t k_block = 64;  // pixels whose run ends fit one word

__attribute__((target("avx2,popcnt"))) void add_avx2(std::span<const ItemCode> codes, CountAccumulator& sum) {
  if (codes.empty()) return;
  const ItemCode* p = codes.data();
  std::size_t run_start = 0, i = 1;
  for (; i + k_block <= codes.size(); i += k_block) {
    std::uint64_t same = 0;
    for (std::size_t lane = 0; lane < k_block; lane += 8) {
      const __m256i here = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p + i + lane));
      const __m256i before = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p + i + lane - 1));
      const auto equal =
          static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpeq_epi32(here, before))));
      same |= std::uint64_t{equal} << lane;
    }
    add_block(~same, i, p, run_start, sum);
  }
  add_tail(codes, i, run_start, sum);
}

__attribute__((target("avx512f,popcnt"))) void add_avx512(std::span<const ItemCode> codes,
                                                          CountAccumulator& sum) {
  if (codes.empty()) return;
  const ItemCode* p = codes.data();
  std::size_t run_start = 0, i = 1;
  for (; i + k_block <= codes.size(); i += k_block) {
    std::uint64_t ends = 0;
    for (std::size_t lane = 0; lane < k_block; lane += 16) {
      const __m512i here = _mm512_loadu_si512(p + i + lane);
      const __m512i before = _mm512_loadu_si512(p + i + lane - 1);
      ends |= std::uint64_t{_mm512_cmpneq_epu32_mask(here, before)} << lane;
    }
    add_block(ends, i, p, run_start, sum);
  }
  add_tail(codes, i, run_start, sum);
}

void add_scalar_runs(std::span<const ItemCode> codes, CountAccumulator& sum) {
  if (!codes.empty()) add_tail(codes, 1, 0, sum);
}

}  // namespace

std::span<const HistogramKernel> histogram_kernels() {
  static const std::array<HistogramKernel, 4> kernels = {{
      {"plain", true, add_plain},
      {"runs", true, add_scalar_runs},
      {"runs_avx2", __builtin_cpu_supports("avx2") != 0, add_avx2},
      {"runs_avx512", __builtin_cpu_supports("avx512f") != 0, add_avx512},
  }};
  return kernels;
}

void add_histogram(std::span<const ItemCode> codes, CountAccumulator& sum) {
  static const auto best = [] {
    const auto kernels = histogram_kernels();
    return std::find_if(kernels.rbegin(), kernels.rend(), [](const auto& kernel) { return kernel.supported; })
        ->add;
  }();
  best(codes, sum);
}

}  // namespace sightline
