#include "main_view/client/c_api/open_questions.hpp"

#include <algorithm>
#include <string>

#include "main_view/client/c_api/failure.hpp"
#include "main_view/client/c_api/structures.hpp"

namespace sightline::c_api {
namespace {

std::uint32_t reason_of(WhyReason reason) {
  switch (reason) {
    case WhyReason::hidden_by_application:
      return SL_WHY_ABSENT;
    case WhyReason::outside_frustum:
      return SL_WHY_OUTSIDE;
    case WhyReason::occluder_only:
      return SL_WHY_OCCLUDER_ONLY;
    case WhyReason::casts_no_shadow:
      return SL_WHY_NO_SHADOW;
    case WhyReason::always_visible:
      return SL_WHY_ALWAYS;
    case WhyReason::no_set:
      return SL_WHY_NO_ANSWER;
    case WhyReason::stale:
      return SL_WHY_STALE;
    case WhyReason::moved_untested:
      return SL_WHY_MOVED;
    case WhyReason::uncovered_by_a_mover:
      return SL_WHY_UNCOVERED;
    case WhyReason::field_not_tested:
      return SL_WHY_UNTESTED;
    case WhyReason::unknown:
      return SL_WHY_UNKNOWN;
    case WhyReason::visible:
      return SL_WHY_VISIBLE;
    case WhyReason::outside_tested_field:
      return SL_WHY_OUTSIDE_TESTED;
    case WhyReason::hidden:
      return SL_WHY_HIDDEN;
    case WhyReason::below_threshold:
      return SL_WHY_BELOW_THRESHOLD;
    case WhyReason::held_by_filter:
      return SL_WHY_HELD;
    case WhyReason::open:
      return SL_WHY_OPEN;
    case WhyReason::boxed:
      return SL_WHY_BOX;
  }
  return SL_WHY_UNKNOWN;
}

}  // namespace

void OpenQuestions::require(std::uint32_t view, std::uint32_t object) const {
  static_cast<void>(views_.at(view));
  if (object < client_.object_count()) return;
  fail(SL_ERROR_RANGE, "object " + std::to_string(object) + " of " + std::to_string(client_.object_count()));
}

std::uint64_t OpenQuestions::ask(std::uint32_t view, std::uint32_t object) {
  require(view, object);
  const std::uint64_t ticket = client_.ask_why(ObjectId{object}, views_.id_of(view));
  open_.push_back({ticket, view});
  if (open_.size() > CullingClient::k_most_questions) open_.pop_front();
  return ticket;
}

sl_status OpenQuestions::take(std::uint64_t question, sl_why& answer) {
  const auto asked = std::find_if(open_.begin(), open_.end(),
                                  [question](const Open& open) { return open.ticket == question; });
  if (asked == open_.end()) fail(SL_ERROR_RANGE, "question " + std::to_string(question) + ": not open");
  const auto report = client_.take_why(question);
  if (!report) return SL_PENDING;
  answer = answer_of(*report, asked->view);
  open_.erase(asked);
  return SL_OK;
}

sl_status OpenQuestions::wait(std::uint32_t view, std::uint32_t object, double timeout_s, sl_why& answer) {
  require(view, object);
  const WhyReport report = client_.wait_why(ObjectId{object}, views_.id_of(view), timeout_s);
  answer = answer_of(report, view);
  return answer.reason == SL_WHY_UNKNOWN && answer.daemon_asked == 0 ? SL_TIMEOUT : SL_OK;
}

sl_why OpenQuestions::answer_of(const WhyReport& report, std::uint32_t view) const {
  sl_why answer{};
  answer.object = index_of(report.id);
  answer.view = view;
  answer.reason = reason_of(report.reason);
  answer.state = views_.object_state(view, answer.object);
  write_text(answer.text, report.text);
  if (!report.daemon) return answer;
  answer.daemon_asked = 1;
  answer.pixels = report.daemon->pixels;
  answer.pixels_mean = report.daemon->pixels_mean;
  answer.threshold = report.daemon->threshold;
  const auto& blockers = report.daemon->hidden_by;
  answer.blocker_count = static_cast<std::uint32_t>(std::min<std::size_t>(blockers.size(), SL_MAX_BLOCKERS));
  for (std::uint32_t i = 0; i < answer.blocker_count; ++i) {
    answer.blockers[i] = index_of(blockers[i].id);
    answer.blocker_pixels[i] = blockers[i].pixels;
  }
  return answer;
}

}  // namespace sightline::c_api
