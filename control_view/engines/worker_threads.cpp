#include "control_view/engines/worker_threads.hpp"

#include <algorithm>
#include <chrono>

namespace sightline {
namespace {

/// Looks for a moment before it sleeps: waking takes about as long as a twentieth of a view. Whoever else
/// wants the core gets it meanwhile. Returns whether it came true.
template <class Condition>
bool soon(Condition holds) {
  constexpr std::chrono::microseconds k_moment{200};
  const auto end = std::chrono::steady_clock::now() + k_moment;
  do {
    if (holds()) return true;
    std::this_thread::yield();
  } while (std::chrono::steady_clock::now() < end);
  return false;
}

}  // namespace

WorkerThreads::WorkerThreads(std::uint32_t count) {
  if (count == 0) count = std::max(1u, std::thread::hardware_concurrency());
  for (std::uint32_t worker = 1; worker < count; ++worker) {
    threads_.emplace_back([this, worker] { wait_for_work(worker); });
  }
}

WorkerThreads::~WorkerThreads() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  begins_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void WorkerThreads::run(const std::function<void(std::uint32_t)>& work) {
  if (threads_.empty()) return work(0);
  {
    const std::lock_guard lock(mutex_);
    work_ = &work;
    at_work_ = static_cast<std::uint32_t>(threads_.size());
    ++round_;
  }
  begins_.notify_all();
  work(0);
  const auto all_done = [this] { return at_work_ == 0; };
  if (soon(all_done)) return;
  std::unique_lock lock(mutex_);
  done_.wait(lock, all_done);
}

void WorkerThreads::wait_for_work(std::uint32_t worker) {
  std::uint64_t last_round = 0;
  const auto called = [&] { return ends_ || round_ != last_round; };
  while (true) {
    if (!soon(called)) {
      std::unique_lock lock(mutex_);
      begins_.wait(lock, called);
    }
    if (ends_) return;
    last_round = round_;
    (*work_)(worker);
    if (--at_work_ == 0) {
      const std::lock_guard lock(mutex_);
      done_.notify_one();
    }
  }
}

}  // namespace sightline
