#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace sightline {

/// Threads that wait for work: the caller is worker 0, so one worker means no thread at all.
class WorkerThreads {
 public:
  /// `count` workers, the caller among them; 0 for one a core.
  explicit WorkerThreads(std::uint32_t count);
  ~WorkerThreads();
  WorkerThreads(const WorkerThreads&) = delete;
  WorkerThreads& operator=(const WorkerThreads&) = delete;

  [[nodiscard]] std::uint32_t count() const noexcept {
    return static_cast<std::uint32_t>(threads_.size()) + 1;
  }

  /// Calls `work(worker)` once on every worker and returns when all are done. `work` must not throw.
  void run(const std::function<void(std::uint32_t)>& work);

 private:
  void wait_for_work(std::uint32_t worker);

  std::mutex mutex_;
  std::condition_variable begins_, done_;
  const std::function<void(std::uint32_t)>* work_ = nullptr;
  std::atomic<std::uint64_t> round_ = 0;
  std::atomic<std::uint32_t> at_work_ = 0;
  std::atomic<bool> ends_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace sightline
