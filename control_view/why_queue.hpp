#pragma once

#include <algorithm>
#include <deque>
#include <optional>

#include "protocol/messages.hpp"

namespace sightline {

/// A session's questions why, until its turn comes. An answer costs as much as a look, so a session is given
/// few a second and the others are dropped.
class WhyQueue {
 public:
  static constexpr double k_a_second = 20.0;

  /// Whether it was taken in. `now_s` never goes back.
  bool add(const Why& why, double now_s) {
    room_ = std::min(k_a_second, room_ + k_a_second * (now_s - last_s_.value_or(now_s)));
    last_s_ = now_s;
    if (room_ < 1.0) return false;
    room_ -= 1.0;
    questions_.push_back(why);
    return true;
  }
  [[nodiscard]] bool empty() const noexcept { return questions_.empty(); }
  /// The oldest. Requires !empty().
  [[nodiscard]] Why take() {
    const Why why = questions_.front();
    questions_.pop_front();
    return why;
  }

 private:
  std::deque<Why> questions_;
  double room_ = k_a_second;
  std::optional<double> last_s_;
};

}  // namespace sightline
