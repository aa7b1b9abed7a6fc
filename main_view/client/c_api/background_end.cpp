#include "main_view/client/c_api/background_end.hpp"

#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

namespace sightline::c_api {
namespace {

/// Counts the ends under way; at the end of the process waits until there are none.
class Ends {
 public:
  ~Ends() {
    std::unique_lock lock(mutex_);
    none_.wait(lock, [this] { return count_ == 0; });
  }
  void begin() {
    const std::lock_guard lock(mutex_);
    ++count_;
  }
  void end() noexcept {
    const std::lock_guard lock(mutex_);
    if (--count_ == 0) none_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable none_;
  int count_ = 0;
};

Ends& ends() {
  static Ends all;
  return all;
}

}  // namespace

void end_in_background(std::unique_ptr<ClientHandle> client) noexcept {
  try {
    Ends& all = ends();
    all.begin();
    ClientHandle* ending = client.get();
    try {
      std::thread([ending, &all] {
        delete ending;
        all.end();
      }).detach();
      static_cast<void>(client.release());
    } catch (...) {
      all.end();
      throw;
    }
  } catch (...) {
    client.reset();
  }
}

}  // namespace sightline::c_api
