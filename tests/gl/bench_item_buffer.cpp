// Engine item_buffer on generated cities, beside drawing everything in the frustum and beside the least that
// any item buffer could do: drawing exactly the visible objects of each view, known beforehand, reading and
// counting. All three look at the same views in turn, 512x384, and the medians are printed as one row a city.
//
//   bench_item_buffer [OBJECTS...]     default 2000 20000 200000

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <future>

#include "common/gl/context.hpp"
#include "common/gl/item_buffer.hpp"
#include "common/scene/generate_city.hpp"
#include "control_view/engines/histogram.hpp"
#include "control_view/engines/item_buffer_engine.hpp"

namespace sightline {
namespace {

constexpr ImageSize k_size{512, 384};
constexpr int k_views = 45;
constexpr double k_step_s = 1.0 / 15.0;

double milliseconds_of(const std::function<void()>& call) {
  const auto began = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began).count();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Eye eye_on(const CameraPath& path, int view) {
  return {camera_from_world(path.at(view * k_step_s)), clip_from_camera(Perspective{}, 4.0 / 3.0)};
}

struct Run {
  std::vector<double> times_ms;
  std::vector<PixelCounts> counts;
  double triangles = 0.0;  ///< drawn, mean a view
};

/// A thread for each: a GL context is current on one.
Run run_engine(std::unique_ptr<VisibilityEngine> (*make)(const Scene&, const EngineOptions&),
               const Scene& scene, const CameraPath& path) {
  return std::async(std::launch::async,
                    [&] {
                      const auto engine = make(scene, {});
                      Run run;
                      for (int view = 0; view < k_views; ++view) {
                        const Eye eye = eye_on(path, view);
                        PixelCounts& counts = run.counts.emplace_back();
                        EngineStats stats;
                        run.times_ms.push_back(milliseconds_of([&] {
                          stats = engine->count({{&eye, 1}, k_size, {}}, counts);
                        }));
                        run.triangles += static_cast<double>(stats.drawn_triangles) / k_views;
                      }
                      return run;
                    })
      .get();
}

/// What is visible of each view, and nothing else.
Run run_visible_only(const Scene& scene, const CameraPath& path, const std::vector<PixelCounts>& truth) {
  return std::async(std::launch::async,
                    [&] {
                      const auto context = gl::make_offscreen_context(gl::ContextKind::osmesa);
                      gl::GpuScene gpu_scene(scene, false);
                      gl::ItemBuffer buffer(k_size, gl::Stencil::without);
                      CountAccumulator sum(scene.object_count());
                      std::vector<ItemCode> codes;
                      Run run;
                      for (int view = 0; view < k_views; ++view) {
                        const Eye eye = eye_on(path, view);
                        gl::DrawStats stats;
                        run.times_ms.push_back(milliseconds_of([&] {
                          stats = buffer.draw(gpu_scene, eye, truth[static_cast<std::size_t>(view)].ids);
                          buffer.read(codes);
                          add_histogram(codes, sum);
                          sum.take(run.counts.emplace_back());
                        }));
                        run.triangles += static_cast<double>(stats.triangles) / k_views;
                      }
                      return run;
                    })
      .get();
}

void compare(std::uint32_t object_count) {
  const Scene scene = generate_city(object_count, 1);
  const CameraPath path = city_path(object_count, 1);
  const Run all = run_engine(make_item_buffer_all_engine, scene, path);
  const Run least = run_visible_only(scene, path, all.counts);
  const Run now = run_engine(make_item_buffer_engine, scene, path);
  double visible = 0.0;
  for (const PixelCounts& counts : all.counts) visible += static_cast<double>(counts.ids.size()) / k_views;
  std::printf(
      "%8u objects, %5.1f visible | everything %8.2f ms %9.0f triangles | visible alone %6.2f ms %6.0f | "
      "item_buffer %6.2f ms %6.0f, %.2f of visible alone, 1/%.1f of everything%s\n",
      object_count, visible, median(all.times_ms), all.triangles, median(least.times_ms), least.triangles,
      median(now.times_ms), now.triangles, median(now.times_ms) / median(least.times_ms),
      median(all.times_ms) / median(now.times_ms), now.counts == all.counts ? "" : " | DIFFERS");
  std::fflush(stdout);
}

}  // namespace
}  // namespace sightline

int main(int count, char** arguments) {
  if (count == 1) {
    for (const std::uint32_t objects : {2'000u, 20'000u, 200'000u}) sightline::compare(objects);
  }
  for (int i = 1; i < count; ++i) {
    const unsigned long objects = std::strtoul(arguments[i], nullptr, 10);
    if (objects == 0 || objects > 1'000'000) {
      std::fprintf(stderr, "bench_item_buffer: '%s' is no number of objects from 1 to 1000000\n",
                   arguments[i]);
      return 2;
    }
    sightline::compare(static_cast<std::uint32_t>(objects));
  }
  return 0;
}
