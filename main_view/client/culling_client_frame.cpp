#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "common/error.hpp"
#include "main_view/client/culling_client_impl.hpp"
#include "protocol/message_checks.hpp"

namespace sightline {
namespace {

constexpr double k_rate_smoothing_s = 1.0;

}  // namespace

ViewTrack& CullingClient::Impl::view(ViewId id) {
  const std::size_t index = index_of(id);
  if (index < views.size() && views[index]) return *views[index];
  throw InputError("view " + std::to_string(index) + " is not there: add_view gives views out");
}

/// Into `eyes`; throws before anything else has changed.
void CullingClient::Impl::sort_poses(std::span<const ViewPose> poses) {
  for (auto& list : eyes) list.clear();
  for (const ViewPose& pose : poses) {
    const ViewTrack& track = view(pose.view);
    auto& list = eyes[index_of(pose.view)];
    if (list.size() >= k_max_eyes) {
      throw InputError("view " + std::to_string(index_of(pose.view)) + " has more than " +
                       std::to_string(k_max_eyes) + " poses: add another view");
    }
    list.push_back(eye_of(pose, track.options().clip_depth));
  }
}

const ClientFrame& CullingClient::Impl::begin_frame(double time_s, std::span<const ViewPose> poses,
                                                    std::optional<double> wait_s) {
  if (!(std::abs(time_s) <= k_max_time_s)) throw InputError("time_s is not a time: give seconds");
  if (time_s < last_time_s) {
    throw InputError("time_s " + std::to_string(time_s) + " is before the last frame's " +
                     std::to_string(last_time_s) + ": give a clock that never goes back");
  }
  sort_poses(poses);
  const double began_s = real_now_s();
  last_time_s = time_s;
  poll();
  file_answers(time_s);
  apply_edits(time_s);
  for (std::size_t i = 0; i < views.size(); ++i) {
    frame.views_[i] = nullptr;
    if (eyes[i].empty()) continue;
    views[i]->begin_frame(time_s, eyes[i]);
    frame.views_[i] = &views[i]->frame();
  }
  send_requests(time_s, wait_s.has_value());
  const double waits_s = real_now_s();
  frame.exact_ = wait_s.has_value() && await_answers(time_s, *wait_s);
  const double waited_s = real_now_s() - waits_s;
  decide(time_s);
  measure(began_s, waited_s);
  hand_out_reports();
  return frame;
}

void CullingClient::Impl::poll() {
  const double now_s = real_now_s();
  std::vector<Answer> arrived = connection.poll(now_s);
  answers.insert(answers.end(), std::make_move_iterator(arrived.begin()),
                 std::make_move_iterator(arrived.end()));
  for (const WhyAnswer& answer : connection.session().take_why_answers()) questions.answer(answer);
  questions.expire(now_s, connection.state() != ClientState::ready);
}

void CullingClient::Impl::file_answers(double received_s) {
  for (Answer& answer : answers) {
    const std::uint8_t view = answer.request.view;
    if (awaited[view] != 0 && answer.request.request_seq >= awaited[view]) awaited[view] = 0;
    ++statistics.answers;
    statistics.daemon_times = answer.frame.times;
    statistics.daemon_drawn_objects = answer.frame.drawn_objects;
    round_trip.add(std::max(received_s - answer.issued_s, 0.0));
    if (!views[view]) continue;
    views[view]->core().accept(std::move(answer.request), answer.issued_s, std::move(answer.set), received_s);
  }
  answers.clear();
  const std::uint64_t lost = connection.session().lost_count();
  if (lost == lost_count) return;
  lost_count = lost;
  for (auto& track : views) {
    if (track) track->core().forget_sets();
  }
}

RequestNumbers CullingClient::Impl::oldest_alive(double time_s) const {
  RequestNumbers oldest;
  oldest.fill(std::numeric_limits<std::uint64_t>::max());
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!views[i]) continue;
    const auto in_flight = connection.session().oldest_in_flight(static_cast<std::uint8_t>(i));
    const auto filed = views[i]->core().oldest_filed_request(time_s);
    if (in_flight) oldest[i] = std::min(oldest[i], *in_flight);
    if (filed) oldest[i] = std::min(oldest[i], *filed);
  }
  return oldest;
}

void CullingClient::Impl::apply_edits(double time_s) {
  objects.take_edits(edits);
  RequestNumbers next{};
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!views[i]) continue;
    views[i]->apply(time_s, edits);
    next[i] = views[i]->core().next_request_seq();
  }
  for (const ObjectId id : edits.removed) objects.ids().retire(id, next);
  if (objects.ids().quarantined_count() > 0) objects.ids().release(oldest_alive(time_s));
  statistics.moved_objects = edits.moved.size() + edits.boxed.size();
}

void CullingClient::Impl::send_requests(double time_s, bool exact) {
  awaited.fill(0);
  asked_all = connection.state() == ClientState::ready;
  if (!asked_all) return;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (frame.views_[i] == nullptr) continue;
    ViewRequest request = views[i]->make_request(time_s, exact);
    const std::uint64_t seq = request.request_seq;
    if (!connection.session().send(std::move(request), time_s)) {
      asked_all = false;
      continue;
    }
    ++statistics.requests;
    if (exact) awaited[i] = seq;
  }
}

bool CullingClient::Impl::await_answers(double time_s, double timeout_s) {
  if (!asked_all && connection.state() != ClientState::ready) return false;
  const double began_s = real_now_s();
  const auto any_awaited = [&] {
    return std::any_of(awaited.begin(), awaited.end(), [](std::uint64_t seq) { return seq != 0; });
  };
  bool lost = false;
  while (any_awaited() || lost) {
    const double left_s = began_s + timeout_s - real_now_s();
    const ClientState state = connection.state();
    if (!(left_s > 0.0) || state == ClientState::refused) return false;
    if (state == ClientState::ready && lost) {  // and found again: it knows nothing of what was asked
      send_requests(time_s, true);
      lost = false;
      continue;
    }
    lost = state != ClientState::ready;
    connection.wait(std::min(left_s, lost ? k_pump_interval_s : 0.1));
    poll();
    file_answers(time_s + (real_now_s() - began_s));
  }
  return asked_all;
}

void CullingClient::Impl::decide(double time_s) {
  const auto in_frame = static_cast<std::size_t>(
      std::count_if(frame.views_.begin(), frame.views_.end(), [](const auto* view) { return view; }));
  bool fell_back = false;
  frame.anywhere_.clear();
  statistics.listed_objects = statistics.visible_objects = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (frame.views_[i] == nullptr) continue;
    views[i]->decide(time_s, objects);
    const ViewFrame& list = views[i]->frame();
    fell_back = fell_back || list.fallback() != Fallback::none;
    statistics.listed_objects += list.visible().size();
    statistics.visible_objects += list.decision().visible_count;
    if (in_frame < 2) continue;
    const auto bits = list.bits();
    frame.anywhere_.resize(bits.size(), 0);
    for (std::size_t word = 0; word < bits.size(); ++word) frame.anywhere_[word] |= bits[word];
  }
  frame.time_s_ = time_s;
  ++statistics.frames;
  if (fell_back) ++statistics.fallback_frames;
}

void CullingClient::Impl::measure(double began_s, double waited_s) {
  const double now_s = real_now_s();
  statistics.begin_frame_s = now_s - began_s - waited_s;
  if (measured_s != 0.0 && now_s > measured_s) {
    const double passed_s = now_s - measured_s;
    const double rate = static_cast<double>(statistics.answers - answers_measured) / passed_s;
    const double weight = 1.0 - std::exp(-passed_s / k_rate_smoothing_s);
    statistics.answers_per_s += weight * (rate - statistics.answers_per_s);
  }
  measured_s = now_s;
  answers_measured = statistics.answers;
}

void CullingClient::Impl::hand_out_reports() {
  if (!why_handler) return;
  const std::vector<WhyReport> reports = questions.take_all();
  for (const WhyReport& report : reports) why_handler(report);
}

std::uint64_t CullingClient::Impl::ask_why(ObjectId id, ViewId view_id) {
  objects.require_id(id);
  const ViewFrame& list = frame.view(view_id);
  WhyReport report;
  report.id = id;
  report.view = view_id;
  report.listed = list.is_visible(id);
  report.reason = view(view_id).why(objects, id);
  const bool told = report.reason <= WhyReason::casts_no_shadow;  // nothing to add to that
  const bool asked =
      !told && connection.session().send_why(questions.next_ticket(), static_cast<std::uint8_t>(view_id), id);
  return questions.add(std::move(report), asked, real_now_s());
}

}  // namespace sightline
