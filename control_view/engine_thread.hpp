#pragma once

#include <condition_variable>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <thread>

#include "control_view/engine.hpp"

namespace sightline {

/// An engine on a thread of its own. A GL context is current on one thread, and a thread has one current
/// context: this is how several engines live side by side. Calls wait until they are done and pass on what
/// they throw.
class EngineThread {
 public:
  /// Throws what make_engine throws.
  EngineThread(const Scene& scene, const EngineOptions& options);
  ~EngineThread();
  EngineThread(const EngineThread&) = delete;
  EngineThread& operator=(const EngineThread&) = delete;

  struct TimedStats {
    EngineStats stats;
    double time_s = 0.0;  ///< of the count alone, taken on the engine's thread
  };
  TimedStats count(const ViewQuery& query, PixelCounts& counts);

 private:
  void run(std::function<void()> call);
  void serve_calls();
  void end();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::packaged_task<void()> call_;  ///< the one waiting, if valid
  bool ends_ = false;
  std::unique_ptr<VisibilityEngine> engine_;  ///< touched by thread_ alone
  std::thread thread_;
};

}  // namespace sightline
