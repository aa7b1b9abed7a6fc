#include "main_view/client/why_questions.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace sightline {

std::uint64_t WhyQuestions::add(WhyReport report, bool waits, double now_s) {
  report.ticket = next_ticket_++;
  const std::uint64_t ticket = report.ticket;
  if (!waits) {
    finish(std::move(report));
    return ticket;
  }
  open_.push_back({std::move(report), now_s});
  if (open_.size() > k_most) {
    finish(std::move(open_.front().report));
    open_.pop_front();
  }
  return ticket;
}

void WhyQuestions::finish(WhyReport report) {
  report.text = text_of(report);
  ready_.push_back(std::move(report));
  if (ready_.size() > k_most) ready_.pop_front();
}

void WhyQuestions::answer(const WhyAnswer& answer) {
  const auto asked = std::find_if(open_.begin(), open_.end(), [&](const Question& question) {
    return question.report.ticket == answer.nonce && question.report.id == answer.object_id;
  });
  if (asked == open_.end()) return;
  WhyReport report = std::move(asked->report);
  open_.erase(asked);
  report.daemon = answer;
  if (report.reason == WhyReason::unknown) report.reason = reason_of(answer.state);
  finish(std::move(report));
}

void WhyQuestions::expire(double now_s, bool all) {
  while (!open_.empty() && (all || now_s - open_.front().asked_s > k_patience_s)) {
    finish(std::move(open_.front().report));
    open_.pop_front();
  }
}

void WhyQuestions::give_up(std::uint64_t ticket) {
  const auto asked = std::find_if(open_.begin(), open_.end(),
                                  [&](const Question& question) { return question.report.ticket == ticket; });
  if (asked == open_.end()) return;
  finish(std::move(asked->report));
  open_.erase(asked);
}

std::optional<WhyReport> WhyQuestions::take(std::uint64_t ticket) {
  const auto found = std::find_if(ready_.begin(), ready_.end(),
                                  [&](const WhyReport& report) { return report.ticket == ticket; });
  if (found == ready_.end()) return {};
  WhyReport report = std::move(*found);
  ready_.erase(found);
  return report;
}

std::vector<WhyReport> WhyQuestions::take_all() {
  std::vector<WhyReport> reports(std::make_move_iterator(ready_.begin()),
                                 std::make_move_iterator(ready_.end()));
  ready_.clear();
  return reports;
}

}  // namespace sightline
