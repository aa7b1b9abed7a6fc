#pragma once

#include <condition_variable>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "control_view/engine.hpp"
#include "control_view/instruction_counter.hpp"

namespace sightline {

/// An engine on a thread of its own. A GL context is current on one thread, and a thread has one current
/// context: this is how several engines live side by side. Calls wait until they are done and pass on what
/// they throw.
class EngineThread {
 public:
  using Make = std::function<std::unique_ptr<VisibilityEngine>()>;

  /// Makes the engine on its thread. Throws what `make` throws.
  explicit EngineThread(const Make& make);
  ~EngineThread();
  EngineThread(const EngineThread&) = delete;
  EngineThread& operator=(const EngineThread&) = delete;

  struct TimedStats {
    EngineStats stats;
    double time_s = 0.0;  ///< of the count alone, taken on the engine's thread
    std::optional<std::uint64_t>
        instructions;  ///< of it, all threads of the engine; where they can be counted
  };
  TimedStats count(const ViewQuery& query, PixelCounts& counts);

  [[nodiscard]] double build_time_s() const noexcept { return build_time_s_; }

 private:
  void run(std::function<void()> call);
  void serve_calls();
  void end();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::packaged_task<void()> call_;  ///< the one waiting, if valid
  bool ends_ = false;
  double build_time_s_ = 0.0;
  std::unique_ptr<VisibilityEngine> engine_;          ///< touched by thread_ alone, as is the next
  std::unique_ptr<InstructionCounter> instructions_;  ///< begun before the engine starts threads of its own
  std::thread thread_;
};

}  // namespace sightline
