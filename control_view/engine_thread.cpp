#include "control_view/engine_thread.hpp"

#include <utility>

#include "control_view/clock.hpp"

namespace sightline {

EngineThread::EngineThread(const Make& make) : thread_([this] { serve_calls(); }) {
  try {
    run([&] {
      instructions_ = std::make_unique<InstructionCounter>();
      const Clock clock = steady_clock();
      const double began_s = clock();
      engine_ = make();
      build_time_s_ = clock() - began_s;
    });
  } catch (...) {
    end();
    throw;
  }
}

EngineThread::~EngineThread() {
  end();
}

void EngineThread::end() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

EngineThread::TimedStats EngineThread::count(const ViewQuery& query, PixelCounts& counts) {
  TimedStats timed;
  run([&] {
    const Clock clock = steady_clock();
    const auto instructions_before = instructions_->read();
    const double began_s = clock();
    timed.stats = engine_->count(query, counts);
    timed.time_s = clock() - began_s;
    const auto instructions_after = instructions_->read();
    if (instructions_before && instructions_after) {
      timed.instructions = *instructions_after - *instructions_before;
    }
  });
  return timed;
}

void EngineThread::run(std::function<void()> call) {
  std::packaged_task<void()> task(std::move(call));
  std::future<void> done = task.get_future();
  {
    const std::lock_guard lock(mutex_);
    call_ = std::move(task);
  }
  changed_.notify_one();
  done.get();
}

void EngineThread::serve_calls() {
  for (std::unique_lock lock(mutex_);;) {
    changed_.wait(lock, [this] { return ends_ || call_.valid(); });
    if (!call_.valid()) break;
    std::packaged_task<void()> call = std::exchange(call_, {});
    lock.unlock();
    call();
    lock.lock();
  }
  engine_.reset();  // where its context is current
}

}  // namespace sightline
