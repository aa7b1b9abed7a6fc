#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <glm/ext/matrix_transform.hpp>
#include <time.h>

#include "main_view/client/culling_core.hpp"
#include "protocol/codec.hpp"

namespace sightline {
namespace {

constexpr std::uint32_t k_objects = 100'000;
constexpr double k_frame_s = 1.0 / 60.0;
constexpr ImageSize k_size{1920, 1080};

/// CPU time of this thread: what others do with the machine does not count.
double cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double seconds_of(const auto& work) {
  const double start_s = cpu_s();
  work();
  return cpu_s() - start_s;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

glm::dvec3 home_of(std::uint32_t id) {
  return {2.0 * (id % 317), 0.0, -2.0 * static_cast<double>(id / 317)};
}

/// Walkers, turning walkers, doors and things that stand and spin; a different one for each id.
glm::dmat4x3 placement_of(std::uint32_t id, double time_s) {
  const glm::dvec3 home = home_of(id);
  const double phase = 0.37 * (id % 1000), turn = (0.5 + 0.002 * (id % 500)) * time_s + phase;
  const glm::dmat4 there = glm::translate(glm::dmat4(1.0), home);
  const glm::dvec3 up(0, 1, 0);
  switch (id / 10 % 4) {
    case 0:
      return glm::dmat4x3(
          glm::translate(there, glm::dvec3(std::cos(phase), 0.0, std::sin(phase)) * (1.4 * time_s)));
    case 1: {  // on a circle of two metres, looking ahead
      const glm::dmat4 turned = glm::rotate(there, turn, up);
      return glm::dmat4x3(glm::translate(turned, {2.0, 0.0, 0.0}));
    }
    case 2:
      return glm::dmat4x3(glm::translate(glm::rotate(there, std::sin(turn), up), {0.5, 0.0, 0.0}));
    default:
      return glm::dmat4x3(glm::rotate(there, turn, up));
  }
}

MovedObject object_at(std::uint32_t id, double time_s) {
  return {ObjectId{id}, placement_of(id, time_s), {{-0.4f, 0.0f, -0.3f}, {0.4f, 1.8f, 0.3f}}};
}

/// A client in front of a daemon that answers each request three frames later.
class World {
 public:
  World() : core_({}, {{glm::dmat4(1.0), clip_from_camera(Perspective{}, 16.0 / 9.0)}}) {
    std::vector<MovedObject> all;
    for (std::uint32_t id = 0; id < k_objects; ++id) all.push_back(object_at(id, 0.0));
    core_.declare_objects(all);
    // A set of five hundred, each seen in some direction ahead.
    std::vector<ObjectId> ids;
    std::vector<DirectionExtent> extents;
    for (std::uint32_t i = 0; i < 500; ++i) {
      ids.push_back(ObjectId{i * 199});
      const auto first = static_cast<std::uint8_t>(150 + i % 84);
      extents.push_back({first, static_cast<std::uint8_t>(first + 2), static_cast<std::uint8_t>(100 + i % 56),
                         static_cast<std::uint8_t>(103 + i % 56), 120});
    }
    set_ = VisibleSet(ids);
    set_.set_extents(extents);
  }

  enum Part { pose, move, request, encoded, accepted, decided, k_parts };
  using Times = std::array<double, k_parts>;

  /// The parts' times, seconds. `changed` moved in this frame.
  Times step(std::span<const MovedObject> changed) {
    Times times{};
    now_s_ += k_frame_s;
    const Pose head{{300.0, 1.7, 5.0}, glm::angleAxis(0.1 * std::sin(now_s_), glm::dvec3(0, 1, 0))};
    times[pose] = seconds_of([&] { core_.add_pose({now_s_, head}); });
    times[move] = seconds_of([&] { core_.move_objects(now_s_, changed); });
    ViewRequest made;
    times[request] = seconds_of([&] { made = core_.make_request(now_s_, k_size); });
    boxed_ = made.boxed.size();
    Message message(std::move(made));
    times[encoded] = seconds_of([&] {
      const Bytes bytes = encode(message);
      bytes_ = bytes.size();
      benchmark::DoNotOptimize(bytes.data());
    });
    in_flight_.push_back(std::get<ViewRequest>(std::move(message)));
    if (in_flight_.size() > 3) {
      ViewRequest answered = std::move(in_flight_.front());
      in_flight_.pop_front();
      times[accepted] =
          seconds_of([&] { core_.accept(std::move(answered), now_s_ - 3 * k_frame_s, set_, now_s_); });
    }
    eyes_ = eyes_of(head, core_.rig());
    times[decided] = seconds_of([&] { decision_ = core_.decide(now_s_, eyes_); });
    return times;
  }

  [[nodiscard]] FrameDecision decide() const { return core_.decide(now_s_, eyes_); }
  [[nodiscard]] double next_s() const { return now_s_ + k_frame_s; }

  std::size_t boxed_ = 0, bytes_ = 0;
  FrameDecision decision_;

 private:
  CullingCore core_;
  VisibleSet set_;
  std::deque<ViewRequest> in_flight_;
  std::vector<Eye> eyes_;
  double now_s_ = 0.0;
};

/// All that a frame costs the client, by its parts; `state.range(0)` objects move in every frame.
void frame_with_moved_objects(benchmark::State& state) {
  World world;
  const auto count = static_cast<std::uint32_t>(state.range(0));
  const std::uint32_t step = count > 0 ? k_objects / count : 1;
  std::vector<MovedObject> changed(count);
  std::array<std::vector<double>, World::k_parts + 1> times_s;  // the last: of the whole frame
  const auto one_frame = [&] {
    for (std::uint32_t i = 0; i < count; ++i) changed[i] = object_at(i * step, world.next_s());
    return world.step(changed);
  };
  for (int i = 0; i < 150; ++i) (void)one_frame();
  for (auto _ : state) {
    const World::Times times = one_frame();
    double whole_s = 0.0;
    for (std::size_t part = 0; part < times.size(); ++part) {
      times_s[part].push_back(times[part]);
      if (part != World::pose) whole_s += times[part];  // the camera's, not the objects'
    }
    times_s.back().push_back(whole_s);
    state.SetIterationTime(whole_s);
  }
  const char* const names[] = {"pose_us",   "move_us",   "request_us", "encode_us",
                               "accept_us", "decide_us", "median_us"};
  for (std::size_t part = 0; part < times_s.size(); ++part)
    state.counters[names[part]] = 1e6 * median(times_s[part]);
  if (!times_s.back().empty())
    state.counters["least_us"] = 1e6 * *std::min_element(times_s.back().begin(), times_s.back().end());
  state.counters["boxed"] = static_cast<double>(world.boxed_);
  state.counters["bytes"] = static_cast<double>(world.bytes_);
  state.counters["untested"] = static_cast<double>(world.decision_.moved.untested.size());
  state.counters["shadows"] = static_cast<double>(world.decision_.moved.shadows.size());
}
BENCHMARK(frame_with_moved_objects)
    ->Arg(0)
    ->Arg(100)
    ->Arg(500)
    ->Arg(2000)
    ->Arg(10'000)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);

/// The frame in which so many begin to move at once, and the few after it.
void frame_when_many_begin(benchmark::State& state) {
  World world;
  std::vector<MovedObject> changed(10'000);
  double worst_s = 0.0;
  for (auto _ : state) {
    for (int i = 0; i < 40; ++i) (void)world.step({});
    for (std::uint32_t i = 0; i < changed.size(); ++i) changed[i] = object_at(i * 10, world.next_s());
    double whole = 0.0;
    for (const double part : world.step(changed)) whole += part;
    worst_s = std::max(worst_s, whole);
    state.SetIterationTime(whole);
  }
  state.counters["worst_us"] = 1e6 * worst_s;
}
BENCHMARK(frame_when_many_begin)->UseManualTime()->Unit(benchmark::kMicrosecond);

/// A frame's decision from two sets of five hundred, when nothing moves.
void decide(benchmark::State& state) {
  World world;
  for (int i = 0; i < 30; ++i) (void)world.step({});
  for (auto _ : state) benchmark::DoNotOptimize(world.decide());
  state.counters["covered"] = world.decide().field_covered;
  state.counters["sets"] = static_cast<double>(world.decide().tested.size());
  state.counters["visible"] = static_cast<double>(world.decide().visible.size());
}
BENCHMARK(decide);

/// One object's answer, when the field is covered and nothing moves; over all objects.
void may_be_visible(benchmark::State& state) {
  World world;
  for (int i = 0; i < 30; ++i) (void)world.step({});
  const Aabb box{{0.0f, 0.0f, 0.0f}, {1.0f, 1.0f, 1.0f}};
  std::uint32_t drawn = 0;
  for (auto _ : state) {
    for (std::uint32_t id = 0; id < k_objects; ++id)
      drawn += world.decision_.may_be_visible(ObjectId{id}, box);
  }
  benchmark::DoNotOptimize(drawn);
  state.counters["covered"] = world.decision_.field_covered;
  state.SetItemsProcessed(state.iterations() * k_objects);
}
BENCHMARK(may_be_visible);

}  // namespace
}  // namespace sightline
