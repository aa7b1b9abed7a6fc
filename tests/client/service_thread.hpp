#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "control_view/daemon_options.hpp"
#include "control_view/scene_intake.hpp"
#include "control_view/service.hpp"

namespace sightline::testing {

/// The daemon's service with its default preset and nothing to serve at first, on a thread of this process.
class ServiceThread {
 public:
  explicit ServiceThread(ImageSize control_size, const std::string& endpoint = "tcp://127.0.0.1:*")
      : link_(endpoint),
        endpoint_(link_.bound_endpoint()),
        intake_(scenes_, IntakeLimits{},
                [](const Scene& scene) {
                  EngineOptions options;
                  options.engine = "raster";
                  options.threads = 1;
                  return make_engine(scene, options);
                }),
        service_(link_, scenes_, &intake_, options_for(control_size), steady_clock()) {
    thread_ = std::thread([this] {
      while (!stop_) service_.step(std::chrono::milliseconds(5));
    });
  }
  ~ServiceThread() {
    stop_ = true;
    thread_.join();
  }
  [[nodiscard]] const std::string& endpoint() const noexcept { return endpoint_; }

 private:
  static ServiceOptions options_for(ImageSize control_size) {
    const DaemonOptions daemon = preset_options("default");
    ServiceOptions options;
    options.engine_name = "raster";
    options.pipeline.size = control_size;
    options.pipeline.filter_length = daemon.filter;
    options.pipeline.threshold_pixels = daemon.threshold;
    options.pipeline.refine = daemon.refine;
    if (!daemon.open) options.pipeline.sample_px.reset();
    options.pipeline.extents = daemon.extents;
    return options;
  }

  SceneStore scenes_;
  ServerLink link_;
  std::string endpoint_;
  SceneIntake intake_;
  Service service_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace sightline::testing
