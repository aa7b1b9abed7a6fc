#include "main_view/app/virtual_daemon.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace sightline {
namespace {

// Frame times are sums of many 1/60: a slot that falls on a frame must not miss it by a rounding error.
constexpr double k_clock_slack_s = 1e-9;

}  // namespace

VirtualDaemon::VirtualDaemon(Ask ask, std::optional<double> rate_hz, double latency_s)
    : ask_(std::move(ask)),
      interval_s_(rate_hz ? 1.0 / *rate_hz : 0.0),
      latency_s_(latency_s),
      free_at_s_(-std::numeric_limits<double>::infinity()) {}

void VirtualDaemon::issue(ViewRequest request, double now_s) {
  start_due(now_s, false);
  waiting_ = Waiting{std::move(request), now_s};
  start_due(now_s, true);
}

/// Starts the waiting request when the daemon became free before (or, if inclusive, at) `now_s`.
void VirtualDaemon::start_due(double now_s, bool inclusive) {
  const double limit_s = inclusive ? now_s + k_clock_slack_s : now_s - k_clock_slack_s;
  if (!waiting_ || free_at_s_ > limit_s) return;
  const double start_s = std::max(free_at_s_, waiting_->issued_s);
  // From the slot, not from the frame that hit it, so that rounding does not add up.
  free_at_s_ = start_s + interval_s_;
  on_the_way_.push_back({ask_(waiting_->request), waiting_->issued_s, start_s + latency_s_});
  waiting_.reset();
}

std::vector<VirtualDaemon::Delivery> VirtualDaemon::deliver(double now_s) {
  start_due(now_s, false);
  std::vector<Delivery> arrived;
  while (!on_the_way_.empty() && on_the_way_.front().received_s <= now_s + k_clock_slack_s) {
    arrived.push_back(std::move(on_the_way_.front()));
    on_the_way_.pop_front();
  }
  return arrived;
}

}  // namespace sightline
