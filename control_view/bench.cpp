#include "control_view/bench.hpp"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>

#include <malloc.h>
#include <nlohmann/json.hpp>

#include "common/camera_path.hpp"
#include "common/error.hpp"
#include "common/scene/load_scene.hpp"
#include "control_view/bench_report.hpp"
#include "control_view/bench_views.hpp"
#include "control_view/choose_engine.hpp"
#include "control_view/engine_thread.hpp"
#include "control_view/find_engine.hpp"
#include "control_view/oracle_engine.hpp"
#include "control_view/version.hpp"
#include "control_view/write_file.hpp"

namespace sightline {
namespace {

constexpr const char* k_reference_engine = "item_buffer_all";
constexpr const char* k_reference_counter = "histogram";

struct Contestant {
  std::unique_ptr<EngineThread> engine;
  EngineTally tally;
  PixelCounts answer;
};

/// What draws exactly what the reference shows, beside the contestants.
struct Oracle {
  std::unique_ptr<EngineThread> thread;
  OracleEngine* engine = nullptr;  ///< on that thread
  std::vector<double> frame_s;
  PixelCounts answer;
};

/// Everything that looks at the views.
struct Field {
  std::vector<Contestant> contestants;
  std::optional<std::size_t> reference;  ///< of them; else `referee` is asked
  std::unique_ptr<EngineThread> referee;
  std::optional<Oracle> oracle;
};

/// "NAME" or "NAME:COUNTER"; throws InputError for one this build has not.
EngineOptions parse_engine(const std::string& text, const BenchOptions& options) {
  const auto colon = text.find(':');
  EngineOptions engine{text.substr(0, colon), "", options.context, options.threads};
  if (engine.engine == k_auto_engine) throw InputError("--engine auto: name the engines to measure");
  if (colon != std::string::npos) {
    engine.counter = text.substr(colon + 1);
    if (engine.counter.empty()) throw InputError("--engine " + text + ": a counter must follow the colon");
  } else if (!find_engine_named(engine.engine).counters.empty()) {
    engine.counter = options.counter;
  }
  return resolved(std::move(engine));
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

bool is_reference(const EngineOptions& engine) {
  return engine.engine == k_reference_engine && engine.counter == k_reference_counter;
}

Contestant make_contestant(const Scene& scene, const EngineOptions& options) {
  Contestant contestant;
  contestant.tally.options = options;
  const std::uint64_t before = memory_use().now;
  contestant.engine = std::make_unique<EngineThread>([&] { return make_engine(scene, options); });
  const std::uint64_t after = memory_use().now;
  contestant.tally.build_s = contestant.engine->build_time_s();
  contestant.tally.build_bytes = after > before ? after - before : 0;
  return contestant;
}

Oracle make_oracle(const Scene& scene, const BenchOptions& options) {
  Oracle oracle;
  oracle.thread = std::make_unique<EngineThread>([&] {
    auto engine = make_oracle_engine(scene, {.context = options.context});
    oracle.engine = engine.get();
    return engine;
  });
  return oracle;
}

Field make_field(const Scene& scene, const std::vector<EngineOptions>& chosen, const BenchOptions& options) {
  Field field;
  bool draws_with_gl = false;
  for (const EngineOptions& engine : chosen) {
    if (is_reference(engine)) field.reference = field.contestants.size();
    draws_with_gl = draws_with_gl || !engine.counter.empty();
    field.contestants.push_back(make_contestant(scene, engine));
  }
  if (!field.reference) {
    const EngineOptions referee{k_reference_engine, k_reference_counter, options.context};
    field.referee = std::make_unique<EngineThread>([&] { return make_engine(scene, referee); });
  }
  if (options.oracle && draws_with_gl && options.views == BenchViews::single) {
    field.oracle = make_oracle(scene, options);
  }
  return field;
}

void show_progress(std::size_t done, std::size_t views) {
  if (done % 100 == 0 || done == views) {
    std::fprintf(stderr, "control_view bench: %zu of %zu views\n", done, views);
  }
}

void ask_oracle(Oracle& oracle, const ViewQuery& query, const PixelCounts& exact) {
  oracle.engine->tell(exact.ids);  // its thread is waiting
  oracle.frame_s.push_back(oracle.thread->count(query, oracle.answer).time_s);
  if (oracle.answer != exact) {
    throw MachineError("bench: drawing just what " + std::string(k_reference_engine) +
                       " shows gave another picture; its answer cannot be trusted here");
  }
}

/// One answer that is not measured: OpenGL compiles its shaders at the first, memory is touched for the first
/// time.
void warm_up(const ViewQuery& query, Field& field) {
  PixelCounts answer;
  for (Contestant& contestant : field.contestants) (void)contestant.engine->count(query, answer);
  if (field.referee) (void)field.referee->count(query, answer);
  if (!field.oracle) return;
  field.oracle->engine->tell(answer.ids);
  (void)field.oracle->thread->count(query, answer);
}

/// An unmeasured look by all but the reference, which remembers nothing: engines that start from what was
/// visible last then find what they would in service, however far apart the views are.
void lead_in(const BenchQuery& look, Field& field) {
  PixelCounts answer;
  for (std::size_t who = 0; who < field.contestants.size(); ++who) {
    if (who != field.reference) {
      (void)field.contestants[who].engine->count({look.eyes, look.size, {}}, answer);
    }
  }
}

void look_at_every_view(const CameraPath& path, const std::vector<double>& times_s,
                        const BenchOptions& options, Field& field) {
  std::vector<EngineThread::TimedStats> timed(field.contestants.size());
  PixelCounts referee_answer;
  for (std::size_t view = 0; view < times_s.size(); ++view) {
    const BenchQuery look = bench_query(options.views, path.at(times_s[view]), options.size);
    const ViewQuery query{look.eyes, look.size, {}};
    if (view == 0) warm_up(query, field);
    if (options.lead_in_s > 0.0) {
      const double before_s = std::max(0.0, times_s[view] - options.lead_in_s);
      lead_in(bench_query(options.views, path.at(before_s), options.size), field);
    }
    for (std::size_t turn = 0; turn < field.contestants.size(); ++turn) {
      const std::size_t who = (view + turn) % field.contestants.size();
      timed[who] = field.contestants[who].engine->count(query, field.contestants[who].answer);
    }
    if (field.referee) (void)field.referee->count(query, referee_answer);
    const PixelCounts& exact = field.reference ? field.contestants[*field.reference].answer : referee_answer;
    const auto pixels = static_cast<double>(look.size.pixel_count() * look.eyes.size());
    for (std::size_t who = 0; who < field.contestants.size(); ++who) {
      Contestant& contestant = field.contestants[who];
      contestant.tally.add(timed[who], contestant.answer, exact, pixels);
    }
    if (field.oracle) ask_oracle(*field.oracle, query, exact);
    show_progress(view + 1, times_s.size());
  }
}

nlohmann::json settings_of(const BenchOptions& options, const SceneDigest& digest, std::size_t views) {
  return {{"scene", options.scene},
          {"scene_digest", to_hex(digest)},
          {"path", options.path},
          {"size", {options.size.width, options.size.height}},
          {"views", name_of(options.views)},
          {"rate_hz", options.rate_hz},
          {"start_s", options.start_s},
          {"step", options.step},
          {"lead_in_s", options.lead_in_s},
          {"context", options.context},
          {"threads", options.threads},
          {"frames", views}};
}

}  // namespace

void bench(const BenchOptions& options) {
  const std::vector<EngineOptions> chosen = chosen_engines(options);
  const CameraPath path = read_camera_path(options.path);
  const std::vector<double> times_s = bench_times(path, options);
  require_writable(options.json);  // now, rather than after minutes, if it is not

  Field field;
  SceneDigest digest;
  double load_s = 0.0;
  std::uint64_t objects = 0, triangles = 0;
  {
    const Clock clock = steady_clock();
    const double began_s = clock();
    const Scene scene = load_scene(options.scene, {.shading = false});
    load_s = clock() - began_s;
    digest = scene.digest;
    objects = scene.object_count();
    triangles = scene.triangle_count();
    field = make_field(scene, chosen, options);
  }
  malloc_trim(0);

  look_at_every_view(path, times_s, options, field);

  nlohmann::json report{{"command_line", options.command_line},
                        {"version", k_version},
                        {"machine", machine_description()},
                        {"settings", settings_of(options, digest, times_s.size())},
                        {"objects", objects},
                        {"triangles", triangles},
                        {"load_ms", load_s * 1e3},
                        {"peak_memory_mb", static_cast<double>(memory_use().peak) / 1e6},
                        {"engines", nlohmann::json::array()},
                        {"oracle", nullptr}};
  for (const Contestant& contestant : field.contestants)
    report["engines"].push_back(to_json(contestant.tally));
  if (field.oracle) report["oracle"] = {{"frame_ms", milliseconds(field.oracle->frame_s)}};
  write_file(options.json, report.dump(2) + "\n");
}

}  // namespace sightline
