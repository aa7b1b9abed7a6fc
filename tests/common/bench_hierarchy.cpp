#include <random>

#include <benchmark/benchmark.h>

#include "common/object_hierarchy.hpp"
#include "common/view.hpp"

// A city-like layer of boxes, seen from street level: the same seeds for the plain loop and the hierarchy.

namespace sightline {
namespace {

std::vector<Aabb> city_boxes(std::int64_t count) {
  std::mt19937_64 random(1);
  const float side = 10.0f * std::sqrt(static_cast<float>(count));  // the same density at every size
  std::uniform_real_distribution<float> place(-side / 2, side / 2);
  std::uniform_real_distribution<float> size(0.5f, 15.0f);
  std::vector<Aabb> boxes(static_cast<std::size_t>(count));
  for (Aabb& box : boxes) {
    box.min = {place(random), 0.0f, place(random)};
    box.max = box.min + glm::vec3(size(random), size(random), size(random));
  }
  return boxes;
}

/// Looks across the whole layer (far beyond its rim) or only 300 m of it.
Frustum street_view(int step, bool whole) {
  const Pose pose{{5.0 * step, 1.7, -3.0 * step}, glm::angleAxis(0.1 * step, glm::dvec3(0, 1, 0))};
  return frustum_of(clip_from_camera({1.0, 0.1, whole ? 1e5 : 300.0}, 4.0 / 3.0) * camera_from_world(pose));
}

void plain_loop(benchmark::State& state) {
  const auto boxes = city_boxes(state.range(0));
  std::vector<ObjectId> found;
  int step = 0;
  for (auto _ : state) {
    const Frustum frustum = street_view(step++ % 60, state.range(1) != 0);
    found.clear();
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if (may_intersect(frustum, boxes[i])) found.push_back(ObjectId{static_cast<std::uint32_t>(i)});
    }
    benchmark::DoNotOptimize(found.data());
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}

void collect_in_frustum(benchmark::State& state) {
  const ObjectHierarchy hierarchy(city_boxes(state.range(0)));
  std::vector<ObjectId> found;
  int step = 0;
  double kept = 0;
  for (auto _ : state) {
    hierarchy.collect_in_frustum(street_view(step++ % 60, state.range(1) != 0), found);
    benchmark::DoNotOptimize(found.data());
    kept += static_cast<double>(found.size());
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.counters["kept"] = benchmark::Counter(kept, benchmark::Counter::kAvgIterations);
}

void build(benchmark::State& state) {
  const auto boxes = city_boxes(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(ObjectHierarchy(boxes));
  state.SetItemsProcessed(state.iterations() * state.range(0));
}

void move_thousand(benchmark::State& state) {
  const auto boxes = city_boxes(state.range(0));
  ObjectHierarchy hierarchy(boxes);
  std::vector<ObjectId> ids;
  std::vector<Aabb> moved;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    ids.push_back(ObjectId{i * 7});
    moved.push_back({boxes[i * 7].min + glm::vec3(1.0f), boxes[i * 7].max + glm::vec3(1.0f)});
  }
  std::vector<Aabb> home;
  for (const ObjectId id : ids) home.push_back(hierarchy.bounds_of(id));
  bool away = false;
  for (auto _ : state) hierarchy.move(ids, (away = !away) ? moved : home);
  state.SetItemsProcessed(state.iterations() * 1000);
}

BENCHMARK(plain_loop)
    ->ArgsProduct({{10'000, 1'000'000}, {0, 1}})
    ->ArgNames({"objects", "whole"})
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(collect_in_frustum)
    ->ArgsProduct({{10'000, 1'000'000}, {0, 1}})
    ->ArgNames({"objects", "whole"})
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(build)->Arg(10'000)->Arg(1'000'000)->Unit(benchmark::kMillisecond);
BENCHMARK(move_thousand)->Arg(10'000)->Arg(1'000'000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace sightline
