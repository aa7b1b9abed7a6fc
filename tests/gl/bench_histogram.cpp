// Counting the codes of a real item buffer against merely reading it.

#include <numeric>
#include <random>

#include <benchmark/benchmark.h>

#include "common/camera_path.hpp"
#include "common/gl/context.hpp"
#include "common/gl/item_buffer.hpp"
#include "common/scene/load_scene.hpp"
#include "control_view/engines/histogram.hpp"
#include "tests/common/test_scenes.hpp"

namespace sightline {
namespace {

/// The bundled building at 512x384, in the courtyard, where many objects are small.
const std::vector<ItemCode>& item_buffer() {
  static const std::vector<ItemCode> codes = [] {
    const auto folder = testing::scenes_folder();
    const Scene scene = load_scene(folder / "clinic_ground.glb", {.shading = false});
    const Pose pose = read_camera_path(folder / "clinic.path.csv").at(34.6);
    const auto context = gl::make_offscreen_context(gl::ContextKind::osmesa);
    gl::GpuScene gpu_scene(scene, false);
    gl::ItemBuffer buffer({512, 384});
    std::vector<ObjectId> ids(scene.object_count());
    for (std::uint32_t i = 0; i < scene.object_count(); ++i) ids[i] = ObjectId{i};
    buffer.draw(gpu_scene, {camera_from_world(pose), clip_from_camera(Perspective{}, 4.0 / 3.0)}, ids);
    std::vector<ItemCode> read;
    buffer.read(read);
    return read;
  }();
  return codes;
}

void read_memory(benchmark::State& state) {
  const auto& codes = item_buffer();
  for (auto _ : state) {
    benchmark::DoNotOptimize(std::accumulate(codes.begin(), codes.end(), ItemCode{0}));
  }
  state.SetBytesProcessed(state.iterations() * std::int64_t(codes.size() * sizeof(ItemCode)));
}
BENCHMARK(read_memory);

void histogram(benchmark::State& state) {
  const auto& codes = item_buffer();
  const HistogramKernel& kernel = histogram_kernels()[static_cast<std::size_t>(state.range(0))];
  state.SetLabel(std::string(kernel.name));
  if (!kernel.supported) {
    state.SkipWithError("not supported by this machine");
    return;
  }
  CountAccumulator sum(10'000);
  PixelCounts counts;
  for (auto _ : state) {
    kernel.add(codes, sum);
    sum.take(counts);
    benchmark::DoNotOptimize(counts.pixels.data());
  }
  state.SetBytesProcessed(state.iterations() * std::int64_t(codes.size() * sizeof(ItemCode)));
}
BENCHMARK(histogram)->DenseRange(0, 3);

/// Random codes in runs of a mean length, from noise to walls.
void histogram_of_runs(benchmark::State& state) {
  const HistogramKernel& kernel = histogram_kernels()[static_cast<std::size_t>(state.range(0))];
  const auto pixels = static_cast<std::size_t>(state.range(1));
  const auto mean_run = static_cast<double>(state.range(2));
  state.SetLabel(std::string(kernel.name));
  if (!kernel.supported) {
    state.SkipWithError("not supported by this machine");
    return;
  }
  std::mt19937 random(1);
  std::uniform_int_distribution<ItemCode> any_code(0, 2000);
  std::geometric_distribution<std::size_t> run(1.0 / mean_run);
  std::vector<ItemCode> codes;
  while (codes.size() < pixels) codes.insert(codes.end(), 1 + run(random), any_code(random));
  codes.resize(pixels);
  CountAccumulator sum(2001);
  PixelCounts counts;
  for (auto _ : state) {
    kernel.add(codes, sum);
    sum.take(counts);
    benchmark::DoNotOptimize(counts.pixels.data());
  }
  state.SetBytesProcessed(state.iterations() * std::int64_t(codes.size() * sizeof(ItemCode)));
}
BENCHMARK(histogram_of_runs)->ArgsProduct({{0, 2, 3}, {128 * 96, 512 * 384, 4096 * 4096}, {1, 2, 4, 20}});

}  // namespace
}  // namespace sightline
