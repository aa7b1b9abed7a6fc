#include "control_view/engines/worker_threads.hpp"

#include <algorithm>

namespace sightline {

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
  if (!threads_.empty()) {
    const std::lock_guard lock(mutex_);
    work_ = &work;
    ++round_;
    at_work_ = static_cast<std::uint32_t>(threads_.size());
  }
  begins_.notify_all();
  work(0);
  std::unique_lock lock(mutex_);
  done_.wait(lock, [this] { return at_work_ == 0; });
}

void WorkerThreads::wait_for_work(std::uint32_t worker) {
  std::uint64_t last_round = 0;
  for (std::unique_lock lock(mutex_);;) {
    begins_.wait(lock, [&] { return ends_ || round_ != last_round; });
    if (ends_) return;
    last_round = round_;
    lock.unlock();
    (*work_)(worker);
    lock.lock();
    if (--at_work_ == 0) done_.notify_one();
  }
}

}  // namespace sightline
