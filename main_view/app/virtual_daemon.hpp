#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "main_view/client/culling_session.hpp"

namespace sightline {

/// A real daemon on a virtual clock: it starts at most `rate_hz` requests a virtual second, always the newest
/// one it has, and its answer arrives `latency_s` of virtual time later. How long the real one takes does not
/// matter, so a replay gives the same result on every machine.
class VirtualDaemon {
 public:
  /// Sends a request to the real daemon and waits for its answer. Throws when there is none.
  using Ask = std::function<Answer(const ViewRequest&)>;

  /// `rate_hz` empty: every request is started when it is issued.
  VirtualDaemon(Ask ask, std::optional<double> rate_hz, double latency_s);

  /// Issues a request at virtual time `now_s`, never earlier than the last. Takes the place of one that
  /// waits.
  void issue(ViewRequest request, double now_s);

  struct Delivery {
    Answer answer;
    double issued_s = 0.0;    ///< virtual
    double received_s = 0.0;  ///< virtual
  };
  /// The answers that have arrived by `now_s`, oldest first.
  [[nodiscard]] std::vector<Delivery> deliver(double now_s);

 private:
  struct Waiting {
    ViewRequest request;
    double issued_s;
  };
  void start_due(double now_s, bool inclusive);

  Ask ask_;
  double interval_s_;
  double latency_s_;
  double free_at_s_;
  std::optional<Waiting> waiting_;
  std::deque<Delivery> on_the_way_;
};

}  // namespace sightline
