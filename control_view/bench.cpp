#include "control_view/bench.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "common/camera_path.hpp"
#include "common/error.hpp"
#include "common/scene/load_scene.hpp"
#include "control_view/bench_report.hpp"
#include "control_view/engine_thread.hpp"
#include "control_view/find_engine.hpp"
#include "control_view/version.hpp"
#include "control_view/write_file.hpp"

namespace sightline {
namespace {

struct Contestant {
  std::unique_ptr<EngineThread> engine;
  EngineTally tally;
};

/// "NAME" or "NAME:COUNTER"; throws InputError for one this build has not.
EngineOptions parse_engine(const std::string& text, const BenchOptions& options) {
  const auto colon = text.find(':');
  EngineOptions engine{text.substr(0, colon), "", options.context};
  engine.counter = colon == std::string::npos ? options.counter : text.substr(colon + 1);
  if (engine.counter.empty()) {
    for (const EngineEntry& entry : engine_registry()) {
      if (entry.name == engine.engine && !entry.counters.empty()) engine.counter = entry.counters.front();
    }
  }
  (void)find_engine(engine);
  return engine;
}

std::vector<EngineOptions> chosen_engines(const BenchOptions& options) {
  std::vector<EngineOptions> chosen;
  for (const std::string& text : options.engines) chosen.push_back(parse_engine(text, options));
  if (!chosen.empty()) return chosen;
  for (const EngineEntry& entry : engine_registry()) {
    chosen.push_back(parse_engine(std::string(entry.name), options));
  }
  return chosen;
}

/// More than four hours at 60 views a second.
constexpr std::uint32_t k_max_frames = 1'000'000;

std::uint32_t frame_count(const CameraPath& path, const BenchOptions& options) {
  if (path.samples.front().time_s < 0.0) throw InputError(options.path + ": its times must not be below 0");
  // The small addition keeps a duration that is a whole number of frames from losing the last to rounding.
  const double on_path = std::floor(path.duration_s() * options.rate_hz + 1e-6) + 1.0;
  const double wanted = options.frames == 0 ? on_path : std::min<double>(options.frames, on_path);
  if (wanted > k_max_frames) {
    throw InputError(options.path + ": more than " + std::to_string(k_max_frames) +
                     " views; give fewer with --frames or a lower --rate");
  }
  return static_cast<std::uint32_t>(wanted);
}

void show_progress(std::uint32_t frame, std::uint32_t frames) {
  if (frame % 100 == 0 || frame == frames)
    std::fprintf(stderr, "control_view bench: %u of %u views\n", frame, frames);
}

void look_at_every_view(const CameraPath& path, std::uint32_t frames, const BenchOptions& options,
                        EngineThread& reference, std::vector<Contestant>& contestants) {
  const double aspect = static_cast<double>(options.size.width) / options.size.height;
  PixelCounts exact;
  PixelCounts answer;
  for (std::uint32_t frame = 0; frame < frames; ++frame) {
    const Eye eye{camera_from_world(path.at(frame / options.rate_hz)),
                  clip_from_camera(Perspective{}, aspect)};
    const ViewQuery query{{&eye, 1}, options.size, {}};
    (void)reference.count(query, exact);
    for (std::size_t turn = 0; turn < contestants.size(); ++turn) {
      Contestant& contestant = contestants[(frame + turn) % contestants.size()];
      const auto [stats, time_s] = contestant.engine->count(query, answer);
      contestant.tally.add(time_s, stats, answer, exact);
    }
    show_progress(frame + 1, frames);
  }
}

}  // namespace

void bench(const BenchOptions& options) {
  const std::vector<EngineOptions> chosen = chosen_engines(options);
  const CameraPath path = read_camera_path(options.path);
  const std::uint32_t frames = frame_count(path, options);
  require_writable(options.json);  // now, rather than after minutes, if it is not

  std::vector<Contestant> contestants;
  std::unique_ptr<EngineThread> reference;
  SceneDigest digest;
  {
    const Scene scene = load_scene(options.scene, {.shading = false});
    digest = scene.digest;
    for (const EngineOptions& engine : chosen) {
      contestants.push_back({std::make_unique<EngineThread>(scene, engine), {}});
      contestants.back().tally.options = engine;
    }
    reference =
        std::make_unique<EngineThread>(scene, EngineOptions{"item_buffer", "histogram", options.context});
  }

  look_at_every_view(path, frames, options, *reference, contestants);

  nlohmann::json report{{"command_line", options.command_line},
                        {"version", k_version},
                        {"machine", machine_description()},
                        {"settings",
                         {{"scene", options.scene},
                          {"scene_digest", to_hex(digest)},
                          {"path", options.path},
                          {"size", {options.size.width, options.size.height}},
                          {"rate_hz", options.rate_hz},
                          {"context", options.context},
                          {"frames", frames}}},
                        {"engines", nlohmann::json::array()}};
  for (const Contestant& contestant : contestants) report["engines"].push_back(to_json(contestant.tally));
  write_file(options.json, report.dump(2) + "\n");
}

}  // namespace sightline
