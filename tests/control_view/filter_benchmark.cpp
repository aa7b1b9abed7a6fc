#include <random>

#include <benchmark/benchmark.h>

#include "control_view/low_pass_filter.hpp"
#include "control_view/threshold.hpp"

namespace sightline {
namespace {

/// Answers as a moving camera gives them: `visible` of a million objects, one in 25 another from answer to
/// answer.
std::vector<PixelCounts> moving_answers(std::uint32_t visible) {
  std::mt19937 random(1);
  std::vector<std::uint32_t> ids;
  for (std::uint32_t i = 0; i < visible; ++i) ids.push_back(i * (1000000 / visible));
  std::vector<PixelCounts> answers;
  for (int answer = 0; answer < 32; ++answer) {
    for (std::uint32_t change = 0; change < visible / 25; ++change) {
      const std::uint32_t i = random() % visible;
      ids[i] = i * (1000000 / visible) + random() % (1000000 / visible);
    }
    PixelCounts counts;
    for (const std::uint32_t id : ids) {
      counts.ids.push_back(ObjectId{id});
      counts.pixels.push_back(1 + random() % 500);
    }
    answers.push_back(std::move(counts));
  }
  return answers;
}

void filter_and_threshold(benchmark::State& state) {
  const auto visible = static_cast<std::uint32_t>(state.range(0));
  const auto answers = moving_answers(visible);
  LowPassFilter filter(8);
  std::vector<ObjectId> scratch;
  std::size_t next = 0;
  for (auto _ : state) {
    filter.add(answers[next++ % answers.size()]);
    benchmark::DoNotOptimize(visible_above(filter.means(), 0.0, scratch));
  }
  state.SetItemsProcessed(state.iterations() * visible);
}
BENCHMARK(filter_and_threshold)->Arg(100)->Arg(1000)->Arg(5000)->Arg(50000)->Unit(benchmark::kMicrosecond);

/// The plain version to compare with: a slot for each of a million objects.
void dense_filter(benchmark::State& state) {
  const auto answers = moving_answers(static_cast<std::uint32_t>(state.range(0)));
  std::vector<std::vector<std::uint32_t>> ring(8, std::vector<std::uint32_t>(1000000));
  std::vector<std::uint64_t> sums(1000000);
  std::vector<ObjectId> visible;
  std::size_t next = 0;
  for (auto _ : state) {
    auto& slot = ring[next % ring.size()];
    for (std::size_t id = 0; id < sums.size(); ++id) sums[id] -= slot[id];
    std::fill(slot.begin(), slot.end(), 0u);
    const PixelCounts& counts = answers[next++ % answers.size()];
    for (std::size_t i = 0; i < counts.ids.size(); ++i) slot[index_of(counts.ids[i])] = counts.pixels[i];
    visible.clear();
    for (std::size_t id = 0; id < sums.size(); ++id) {
      sums[id] += slot[id];
      if (sums[id] > 0) visible.push_back(ObjectId{static_cast<std::uint32_t>(id)});
    }
    benchmark::DoNotOptimize(VisibleSet(visible));
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(dense_filter)->Arg(5000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace sightline
