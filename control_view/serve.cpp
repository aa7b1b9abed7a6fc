#include "control_view/serve.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include <malloc.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/scene/load_scene.hpp"
#include "control_view/choose_engine.hpp"
#include "control_view/service.hpp"
#include "control_view/stop_signal.hpp"
#include "control_view/write_file.hpp"

namespace sightline {
namespace {

/// Short, so that a signal is noticed well within a tenth of a second.
constexpr std::chrono::milliseconds k_longest_wait{25};

void log_to_stderr(const std::string& level) {
  auto logger = spdlog::stderr_logger_st("control_view");
  logger->set_pattern("%Y-%m-%d %H:%M:%S.%e control_view %l: %v");
  logger->set_level(spdlog::level::from_str(level));
  spdlog::set_default_logger(std::move(logger));
}

/// Lets blocks that were freed be used again instead of going back to the kernel and coming from it anew, a
/// page fault for every 4 KiB: most of what receiving a scene costs. These are glibc's own limits once blocks
/// as large have been freed; malloc_trim() still gives back what a scene's engine left.
void keep_freed_memory() {
  constexpr int k_largest_kept_bytes = 32 << 20;
  (void)mallopt(M_MMAP_THRESHOLD, k_largest_kept_bytes);
  (void)mallopt(M_TRIM_THRESHOLD, 2 * k_largest_kept_bytes);
}

LinkOptions link_options(const DaemonOptions& options) {
  LinkOptions link;
  if (!options.keys.empty()) link.curve = read_curve_keys(options.keys);
  return link;
}

ServiceOptions service_options(const DaemonOptions& options, const EngineOptions& engine) {
  ServiceOptions service;
  service.pipeline = {options.size, options.filter, options.threshold, options.refine};
  if (!options.open) service.pipeline.sample_px.reset();
  service.pipeline.extents = options.extents;
  service.engine_name = engine.engine;
  service.counter_name = engine.counter;
  service.preset_name = options.preset;
  service.max_sessions = options.max_sessions;
  service.silence_limit_s = options.silence_limit_s;
  service.answer_rate_hz = options.control_rate_hz;
  return service;
}

/// What is served from the start.
struct Served {
  ServedScenePtr own;    ///< null without a scene file
  EngineOptions engine;  ///< as chosen for it
  std::string why;       ///< one line for the log
};

/// Engines for scenes that come over the wire. They are made on one thread and used on another, which an
/// OpenGL context does not allow.
EngineOptions engine_for_uploads(const EngineOptions& options) {
  const bool on_cpu = options.engine == "raster" || options.engine == "raycast";
  EngineOptions engine = options;
  if (!on_cpu) {
    engine.engine = "raster";
    engine.counter.clear();
  }
  return engine;
}

/// Loads the scene and hands it to the engine. The arrays die here: from now on the geometry is the engine's.
Served make_served(const DaemonOptions& options) {
  if (options.scene.empty())
    return {nullptr, engine_for_uploads(options.engine), "no scene yet: waiting for clients to bring one"};
  Served served;
  {
    const Scene scene = load_scene(options.scene, {.shading = false});
    ChosenEngine chosen = choose_engine(scene, options.engine, options.size, steady_clock());
    served.own = served_scene({scene.digest, scene.object_count()}, std::move(chosen.engine));
    served.engine = chosen.options;
    served.why = chosen.why;
  }
  malloc_trim(0);
  return served;
}

IntakeLimits intake_limits(const DaemonOptions& options) {
  constexpr std::uint64_t k_mib = 1u << 20;
  IntakeLimits limits;
  limits.scene_bytes = options.max_scene_mib * k_mib;
  limits.all_bytes = options.max_scenes_mib * k_mib;
  limits.scenes = options.max_scenes;
  limits.objects = options.max_objects;
  limits.triangles = options.max_triangles;
  return limits;
}

/// The endpoint in a file, for as long as it is served.
class Announcement {
 public:
  Announcement(std::string file, const std::string& endpoint) : file_(std::move(file)) {
    if (!file_.empty()) write_file(file_, endpoint + "\n");
  }
  ~Announcement() {
    std::error_code ignored;
    if (!file_.empty()) std::filesystem::remove(file_, ignored);
  }
  Announcement(const Announcement&) = delete;
  Announcement& operator=(const Announcement&) = delete;

 private:
  std::string file_;
};

/// Removes the path of an ipc:// endpoint, which libzmq leaves behind now and then. Declare it before the
/// link.
struct SocketFile {
  std::string endpoint;
  SocketFile() = default;
  SocketFile(const SocketFile&) = delete;
  SocketFile& operator=(const SocketFile&) = delete;
  ~SocketFile() {
    const std::string scheme = "ipc://";
    std::error_code ignored;
    if (endpoint.starts_with(scheme)) std::filesystem::remove(endpoint.substr(scheme.size()), ignored);
  }
};

/// Runs the service until a signal.
void serve_on(ServerLink& link, Served& served, const DaemonOptions& options, const StopSignal& stop) {
  SceneStore scenes(served.own);
  std::optional<SceneIntake> intake;
  if (options.uploads) {
    intake.emplace(scenes, intake_limits(options),
                   [engine = engine_for_uploads(served.engine)](const Scene& scene) {
                     return make_engine(scene, engine);
                   });
  }
  Service service(link, scenes, intake ? &*intake : nullptr, service_options(options, served.engine),
                  steady_clock());
  const std::string endpoint = link.bound_endpoint();
  const Announcement announcement(options.announce, endpoint);
  std::printf("control_view: listening on %s\n", endpoint.c_str());
  std::fflush(stdout);
  if (served.own != nullptr) {
    spdlog::info("serving {} ({} objects, digest {})", options.scene, served.own->identity.object_count,
                 to_hex(served.own->identity.digest));
  }
  spdlog::info("{}", served.why);

  while (!stop.requested()) service.step(k_longest_wait);

  service.shut_down();
  // The link drops what it has not sent when it closes.
  std::this_thread::sleep_for(std::chrono::milliseconds{10});
  const ServiceCounters& counters = service.counters();
  spdlog::info("stopped: {} answered, {} superseded, {} malformed, {} sessions opened, {} reaped",
               counters.answered, counters.superseded, counters.malformed, counters.opened, counters.reaped);
}

}  // namespace

void serve(const DaemonOptions& options) {
  StopSignal stop;
  keep_freed_memory();
  log_to_stderr(options.log);
  if (options.scene.empty() && !options.uploads) {
    throw InputError(
        "no scene given, and none may be uploaded: use --scene FILE, or `scene` in the config file, or "
        "--uploads on");
  }
  (void)resolved(options.engine);

  LinkOptions settings = link_options(options);

  Served served = make_served(options);
  const std::uint32_t own_objects = served.own == nullptr ? 0 : served.own->identity.object_count;
  settings.max_frame_bytes =
      largest_frame_of_a_client(options.uploads ? std::max(own_objects, options.max_objects) : own_objects);
  // Bound only now: whoever can connect is answered at once, and until now a signal had nothing to clean up.
  stop.defer();
  SocketFile socket_file;
  ServerLink link(options.bind, settings);
  socket_file.endpoint = link.bound_endpoint();
  serve_on(link, served, options, stop);
}

}  // namespace sightline
