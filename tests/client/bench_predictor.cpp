#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>

#include "main_view/client/motion_predictor.hpp"
#include "tests/client/reference_fit.hpp"

namespace sightline {
namespace {

struct Samples {
  std::vector<double> times_s;
  std::vector<PoseComponents> values;
};

PoseComponents at(double time_s) {
  const double yaw = 0.4 * std::sin(1.7 * time_s);
  return {1.3 * time_s,
          1.7 + 0.02 * std::sin(11.0 * time_s),
          0.3 * std::cos(time_s),
          std::cos(yaw),
          0.0,
          std::sin(yaw),
          0.0};
}

Samples head_motion(int count) {
  Samples samples;
  for (int i = 0; i < count; ++i) {
    samples.times_s.push_back(i / 60.0);
    samples.values.push_back(at(i / 60.0));
  }
  return samples;
}

void fit_with_tiny_solver(benchmark::State& state) {
  const Samples samples = head_motion(20);
  for (auto _ : state) benchmark::DoNotOptimize(fit_and_extrapolate(samples.times_s, samples.values, 2, 0.4));
}
BENCHMARK(fit_with_tiny_solver);

void fit_with_full_solver(benchmark::State& state) {
  const Samples samples = head_motion(20);
  for (auto _ : state) {
    benchmark::DoNotOptimize(testing::full_solver_value(samples.times_s, samples.values, 2, 0.4));
  }
}
BENCHMARK(fit_with_full_solver);

void fit_in_closed_form(benchmark::State& state) {
  const Samples samples = head_motion(20);
  for (auto _ : state) {
    benchmark::DoNotOptimize(testing::closed_form_value(samples.times_s, samples.values, 2, 0.4));
  }
}
BENCHMARK(fit_in_closed_form);

/// What a frame costs: file a pose, settle old predictions, fit and predict.
void add_pose_and_predict(benchmark::State& state, PredictorKind kind) {
  CullingOptions options;
  options.predictor = kind;
  PoseHistory history(options);
  MotionPredictor predictor(options);
  int frame = 0;
  for (auto _ : state) {
    const double time_s = frame++ / 60.0;
    const PoseComponents v = at(time_s);
    history.add({time_s, {{v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]}}});
    predictor.observe(history);
    benchmark::DoNotOptimize(predictor.predict(history, time_s + 0.083));
  }
}
BENCHMARK_CAPTURE(add_pose_and_predict, adaptive, PredictorKind::adaptive);
BENCHMARK_CAPTURE(add_pose_and_predict, fixed, PredictorKind::fixed);

void fit_the_bank(benchmark::State& state) {
  std::vector<TimedPose> samples;
  for (int i = 0; i < 20; ++i) {
    const PoseComponents v = at(i / 60.0);
    samples.push_back({i / 60.0, {{v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]}}});
  }
  for (auto _ : state) benchmark::DoNotOptimize(fit_bank(samples));
}
BENCHMARK(fit_the_bank);

}  // namespace
}  // namespace sightline
