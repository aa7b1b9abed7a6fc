#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace sightline {

/// Does jobs one after another on a thread of its own. Whoever gave them takes what became of them, in the
/// same order, when it suits.
template <class Job, class Result>
class Worker {
 public:
  /// `work` is called on the worker's thread and must not throw.
  explicit Worker(std::function<Result(Job)> work) : work_(std::move(work)), thread_([this] { run(); }) {}
  /// Waits for the job at hand; what has not been begun is dropped.
  ~Worker() {
    {
      const std::lock_guard lock(mutex_);
      ends_ = true;
      jobs_.clear();
    }
    changed_.notify_one();
    thread_.join();
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  void give(Job job) {
    {
      const std::lock_guard lock(mutex_);
      jobs_.push_back(std::move(job));
    }
    changed_.notify_one();
  }

  /// What became of a job, if any is done.
  [[nodiscard]] std::optional<Result> take() {
    const std::lock_guard lock(mutex_);
    if (results_.empty()) return {};
    Result result = std::move(results_.front());
    results_.pop_front();
    return result;
  }

 private:
  void run() {
    for (std::unique_lock lock(mutex_);;) {
      changed_.wait(lock, [this] { return ends_ || !jobs_.empty(); });
      if (ends_) return;
      Job job = std::move(jobs_.front());
      jobs_.pop_front();
      lock.unlock();
      Result result = work_(std::move(job));
      lock.lock();
      results_.push_back(std::move(result));
    }
  }

  std::function<Result(Job)> work_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  std::deque<Result> results_;
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace sightline
