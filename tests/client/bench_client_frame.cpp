#include <algorithm>
#include <ctime>
#include <random>
#include <thread>

#include <benchmark/benchmark.h>

#include "main_view/client/culling_client.hpp"
#include "main_view/client/view_culler.hpp"
#include "tests/client/client_scenes.hpp"
#include "tests/client/scripted_daemon.hpp"

namespace sightline {
namespace {

using testing::strewn_objects;
using testing::view_pose;

constexpr std::uint32_t k_object_count = 100'000;

/// As many of a city's objects as a street shows.
VisibleSet seen_set(std::uint32_t count) {
  std::mt19937 random(1);
  std::vector<ObjectId> ids;
  for (std::uint32_t i = 0; i < k_object_count; i += k_object_count / count)
    ids.push_back(ObjectId{i + static_cast<std::uint32_t>(random() % (k_object_count / count))});
  return VisibleSet(ids);
}

/// The list of a frame from its decision; range: objects in the set.
void list_of_a_covered_view(benchmark::State& state) {
  ObjectTable objects(std::make_shared<const SceneObjects>(strewn_objects(k_object_count, 1000.0f, 1)));
  ViewCuller culler(ViewKind::image);
  ViewFrame frame;
  FrameDecision decision;
  decision.fallback = Fallback::none;
  decision.field_covered = true;
  decision.visible = seen_set(static_cast<std::uint32_t>(state.range(0)));
  const Eye eye = eye_of(view_pose(ViewId{}, {0, 0, 500}), ClipDepth::minus_one_to_one);
  for (auto _ : state) {
    culler.cull(objects, {&eye, 1}, decision, frame);
    benchmark::DoNotOptimize(frame.visible().data());
  }
  state.counters["listed"] = static_cast<double>(frame.visible().size());
}
BENCHMARK(list_of_a_covered_view)->Arg(500)->Arg(2000)->Arg(5000)->Unit(benchmark::kMicrosecond);

/// A frame without a set: all in the frustum.
void list_of_a_fallback(benchmark::State& state) {
  ObjectTable objects(std::make_shared<const SceneObjects>(strewn_objects(k_object_count, 1000.0f, 1)));
  ViewCuller culler(ViewKind::image);
  ViewFrame frame;
  const Eye eye = eye_of(view_pose(ViewId{}, {0, 0, 500}), ClipDepth::minus_one_to_one);
  for (auto _ : state) culler.cull(objects, {&eye, 1}, FrameDecision(), frame);
  state.counters["listed"] = static_cast<double>(frame.visible().size());
}
BENCHMARK(list_of_a_fallback)->Unit(benchmark::kMicrosecond);

void state_of_one_object(benchmark::State& state) {
  ObjectTable objects(std::make_shared<const SceneObjects>(strewn_objects(k_object_count, 1000.0f, 1)));
  ViewCuller culler(ViewKind::image);
  ViewFrame frame;
  const Eye eye = eye_of(view_pose(ViewId{}, {0, 0, 500}), ClipDepth::minus_one_to_one);
  culler.cull(objects, {&eye, 1}, FrameDecision(), frame);
  std::uint32_t id = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(frame.is_visible(ObjectId{id}));
    id = (id + 7919) % k_object_count;
  }
}
BENCHMARK(state_of_one_object);

/// Processor time of this thread: the daemon's and what the machine does besides are left out.
double processor_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Whole frames of a client with a daemon that answers at once; range: objects moved in each.
void begin_frame(benchmark::State& state) {
  SceneObjects scene = strewn_objects(k_object_count, 1000.0f, 1);
  testing::ScriptedDaemon::Script script;
  script.scenes = {scene.digest};
  script.object_count = k_object_count;
  script.see = [set = seen_set(2000)](const ViewRequest&) { return set; };
  testing::ScriptedDaemon daemon(script);
  ClientOptions options;
  options.endpoint = daemon.endpoint();
  CullingClient client(options, scene);
  const ViewId view = client.add_view();
  if (client.wait_until_ready(10.0) != ClientState::ready) return state.SkipWithError("no session");
  std::vector<ObjectId> ids;
  std::vector<glm::dmat4x3> places;
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(state.range(0)); ++i) {
    ids.push_back(ObjectId{10 * i});
    places.push_back(scene.objects[10 * i].world_from_object);
  }
  double time_s = 0.0;
  double fallbacks = 0.0, covered = 0.0;
  std::vector<double> took_us;
  for (auto _ : state) {
    time_s += 1.0 / 60.0;
    for (glm::dmat4x3& place : places) place[3][0] += 0.01;
    const ViewPose pose = view_pose(view, {0, 0, 500}, 0.1 * std::sin(time_s));
    const double began_s = processor_s();
    client.move_objects(ids, places);
    const ClientFrame& frame = client.begin_frame(time_s, {&pose, 1});
    took_us.push_back(1e6 * (processor_s() - began_s));
    state.SetIterationTime(1e-6 * took_us.back());
    covered += frame.view().decision().field_covered ? 1.0 : 0.0;
    fallbacks += frame.view().fallback() != Fallback::none ? 1.0 : 0.0;
    std::this_thread::sleep_for(std::chrono::milliseconds(4));
  }
  const auto middle = took_us.begin() + static_cast<std::ptrdiff_t>(took_us.size() / 2);
  std::nth_element(took_us.begin(), middle, took_us.end());
  state.counters["median_us"] = *middle;
  state.counters["fallbacks"] = fallbacks;
  state.counters["covered"] = covered;
  state.counters["horizon"] = client.statistics().horizon_s;
  state.counters["listed"] = static_cast<double>(client.statistics().listed_objects);
  state.counters["answers"] = static_cast<double>(client.statistics().answers);
}
BENCHMARK(begin_frame)->Arg(0)->Arg(10'000)->UseManualTime()->Iterations(300)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace sightline
