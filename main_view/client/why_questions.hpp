#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "main_view/client/why_report.hpp"

namespace sightline {

/// Questions that wait for the daemon, and reports that wait for whoever asked. Both bounded: the oldest
/// goes.
class WhyQuestions {
 public:
  static constexpr std::size_t k_most = 256;
  /// The daemon drops questions when there are too many: after this long one is answered without it.
  static constexpr double k_patience_s = 1.0;

  /// `report` holds the client's part; `waits`: the daemon was asked, too. Sets and returns its ticket.
  std::uint64_t add(WhyReport report, bool waits, double now_s);
  /// The ticket that the next add gives, and so the nonce to ask the daemon with.
  [[nodiscard]] std::uint64_t next_ticket() const noexcept { return next_ticket_; }

  void answer(const WhyAnswer& answer);
  /// Gives up waiting for questions asked too long ago, or for all.
  void expire(double now_s, bool all = false);

  /// Of one question: its report is ready then.
  void give_up(std::uint64_t ticket);

  [[nodiscard]] std::optional<WhyReport> take(std::uint64_t ticket);
  /// Everything that is ready.
  [[nodiscard]] std::vector<WhyReport> take_all();

 private:
  struct Question {
    WhyReport report;
    double asked_s = 0.0;
  };
  void finish(WhyReport report);

  std::deque<Question> open_;
  std::deque<WhyReport> ready_;
  std::uint64_t next_ticket_ = 1;
};

}  // namespace sightline
