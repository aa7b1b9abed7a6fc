// What the C interface costs a frame and an object, 100,000 objects, a control_view answering over loopback.
// The scene is a town of houses of which a street sees a few hundred to a few thousand.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "tests/c_api/c_program.hpp"
#include "tests/integration/process.hpp"

namespace sightline::testing {
namespace {

constexpr int k_side = 316;  // 99,856 objects

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// A client whose town is at the daemon, after a second of frames.
class Town {
 public:
  explicit Town(double camera_height) : daemon_({}), height_(camera_height) {
    for (int row = 0; row < k_side; ++row) {
      for (int column = 0; column < k_side; ++column) {
        const double height = 5.0 + (row * 7919 + column * 104729) % 13;
        scene_.add(
            box_at(15.0 * (column - k_side / 2), 0.5 * height, 15.0 * (row - k_side / 2), 10, height, 10));
      }
    }
    client_ = std::make_unique<CClient>(options_for(scene_, daemon_.endpoint().c_str()));
    if (sl_wait_open(client(), 60.0) != SL_OK) {
      std::cerr << "no session: " << sl_last_error(client()) << "\n";
      std::exit(1);
    }
    for (int i = 0; i < 60; ++i) {
      begin_frame();
      const timespec pause{0, 16'000'000};
      nanosleep(&pause, nullptr);
    }
  }
  [[nodiscard]] sl_client client() const { return client_->get(); }
  /// The frame of this moment: a walk down a street, looking about. Valid until the next call.
  const sl_frame& next_frame() {
    const double time_s = now_s();
    views_ = {view_of(camera(7.5, height_, 100.0 - 0.5 * (time_s - start_s_), 0.2 * std::sin(0.7 * time_s)),
                      perspective(0.1, 4000.0))};
    frame_ = frame_of(views_, time_s);
    return frame_;
  }
  void begin_frame() {
    if (sl_begin_frame(client(), &next_frame()) != SL_OK) std::exit(1);
  }

 private:
  Daemon daemon_;
  CScene scene_;
  std::unique_ptr<CClient> client_;
  double height_;
  double start_s_ = now_s();
  std::vector<sl_view> views_;
  sl_frame frame_{};
};

Town& town(double camera_height) {
  static std::unique_ptr<Town> made;
  static double height = 0.0;
  if (!made || height != camera_height) {
    made.reset();
    made = std::make_unique<Town>(camera_height);
    height = camera_height;
  }
  return *made;
}

/// Processor time of this thread: what the machine does besides is left out.
double processor_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

/// begin_frame and the list, in processor time; `pause_us` between frames, as a renderer has. c_layer_us is
/// what C adds to the C++ client's own begin_frame, in real time.
void frame(benchmark::State& state) {
  Town& scene = town(static_cast<double>(state.range(0)));
  const timespec pause{0, 1000 * state.range(1)};
  std::vector<double> took_us, added_us, waited_us;
  double listed = 0.0, unanswered = 0.0;
  for (auto _ : state) {
    const sl_frame& frame = scene.next_frame();
    const std::uint32_t* ids = nullptr;
    std::size_t count = 0;
    const double began_processor_s = processor_s(), began_s = now_s();
    sl_begin_frame(scene.client(), &frame);
    sl_visible_ids(scene.client(), 0, &ids, &count);
    const double real = now_s() - began_s, processor = processor_s() - began_processor_s;
    benchmark::DoNotOptimize(ids);
    state.SetIterationTime(processor);
    took_us.push_back(1e6 * processor);
    waited_us.push_back(1e6 * real);
    auto statistics = made<sl_statistics>();
    sl_get_statistics(scene.client(), &statistics);
    added_us.push_back(1e6 * (real - statistics.begin_frame_s));
    listed += static_cast<double>(count);
    auto info = made<sl_view_info>();
    sl_get_view_info(scene.client(), 0, &info);
    if (info.answered == 0) unanswered += 1.0;
    if (pause.tv_nsec > 0) nanosleep(&pause, nullptr);
  }
  state.counters["listed"] = listed / static_cast<double>(state.iterations());
  state.counters["unanswered"] = unanswered;
  state.counters["median_us"] = median(took_us);
  state.counters["median_real_us"] = median(waited_us);
  state.counters["c_layer_us"] = median(added_us);
}

void one_objects_state(benchmark::State& state) {
  Town& scene = town(2.0);
  scene.begin_frame();
  std::uint32_t object = 0, visible = 0;
  for (auto _ : state) {
    visible += sl_object_state(scene.client(), 0, object) == SL_VISIBLE ? 1 : 0;
    object = object + 1 == k_side * k_side ? 0 : object + 1;
  }
  benchmark::DoNotOptimize(visible);
  state.SetItemsProcessed(state.iterations());
}

constexpr int k_frame_us = 16'000;
BENCHMARK(frame)->Args({2, k_frame_us})->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(600);
BENCHMARK(frame)->Args({2, 1000})->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(3000);
BENCHMARK(frame)->Args({60, k_frame_us})->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(600);
BENCHMARK(one_objects_state)->Repetitions(5)->ReportAggregatesOnly();

}  // namespace
}  // namespace sightline::testing
