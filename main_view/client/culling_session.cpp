#include "main_view/client/culling_session.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "main_view/client/session_sets.hpp"
#include "protocol/codec.hpp"

namespace sightline {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int k_max_frames_a_poll = 256;   // a daemon gone mad must not hold up the picture
constexpr double k_longest_backoff = 4.0;  // times reconnect_interval_s
constexpr double k_clock_slack = 1.01;     // adding an interval to a clock and taking it off again rounds
constexpr double k_pings_a_silence = 4.0;  // pings sent before silence counts as a loss

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

struct CullingSession::Impl {
  explicit Impl(SessionOptions given) : options(std::move(given)), link(options.endpoint, options.link) {
    limits.max_frame_bytes = options.link.max_frame_bytes;
  }

  void step(double now_s);
  void read_all(double now_s);
  void take_frame(const Bytes& frame, double now_s);
  void say_hello(double now_s);
  void send_message(const Message& message) { link.send(encode(message)); }
  void lose();
  void forget_views();
  void refuse(Refusal why);

  void on(const Welcome& message, double now_s);
  void on(const Refusal& message, double now_s);
  void on(VisibleSetFrame message, double now_s);
  void on(const WhyAnswer& message, double now_s);
  void on(const Ping& message, double) { send_message(Pong{message.nonce, message.time_s}); }
  void on(const Pong&, double) {}
  template <typename ForTheDaemon>
  void on(const ForTheDaemon&, double) {
    ++bad_frames;
  }

  SessionOptions options;
  ClientLink link;
  DecodeLimits limits;
  SessionState state = SessionState::connecting;
  std::optional<Welcome> welcome;
  std::optional<Refusal> refusal;
  struct View {
    SessionSets sets;
    RequestsInFlight in_flight;
  };
  std::array<View, k_max_views> views;
  std::vector<Answer> answers;         // not yet handed out
  std::vector<WhyAnswer> why_answers;  // likewise
  std::uint64_t lost_count = 0;
  std::uint64_t bad_frames = 0;

  // All in the caller's clock, which may be virtual.
  double last_step_s = 0.0;
  bool stepped = false;
  std::optional<double> next_hello_s;
  double hello_backoff = 1.0;
  double silence_s = 0.0;  // heard nothing for so long while the caller was listening
  double pinged_at_silence_s = 0.0;
  std::uint64_t next_nonce = 1;
};

void CullingSession::Impl::step(double now_s) {
  read_all(now_s);
  // A caller that does not poll for a while (a long frame, a stopped debugger) is not the daemon's silence.
  const double ping_interval_s = options.silence_limit_s / k_pings_a_silence;
  const double passed_s = stepped ? std::clamp(now_s - last_step_s, 0.0, ping_interval_s) : 0.0;
  last_step_s = now_s;
  stepped = true;
  if (state == SessionState::open) {
    silence_s += passed_s;
    if (silence_s > options.silence_limit_s) {
      lose();
    } else if (silence_s - pinged_at_silence_s >= ping_interval_s) {
      pinged_at_silence_s = silence_s;
      send_message(Ping{next_nonce++, now_s});
    }
  }
  if (state == SessionState::connecting) say_hello(now_s);
}

void CullingSession::Impl::read_all(double now_s) {
  for (int i = 0; i < k_max_frames_a_poll; ++i) {
    const std::optional<Bytes> frame = link.receive(std::chrono::milliseconds(0));
    if (!frame) return;
    take_frame(*frame, now_s);
  }
}

void CullingSession::Impl::take_frame(const Bytes& frame, double now_s) {
  auto decoded = decode(frame, limits);
  auto* message = std::get_if<Message>(&decoded);
  if (message == nullptr) {
    ++bad_frames;
    return;
  }
  silence_s = 0.0;
  pinged_at_silence_s = 0.0;
  if (state == SessionState::refused) return;
  std::visit([&](auto& content) { on(std::move(content), now_s); }, *message);
}

void CullingSession::Impl::say_hello(double now_s) {
  // A virtual clock may run slower than the real one that wait_until_open counted by.
  const double longest_s = options.reconnect_interval_s * k_longest_backoff;
  if (next_hello_s && now_s < *next_hello_s && *next_hello_s - now_s <= k_clock_slack * longest_s) return;
  // Anew each time, or the Hellos that pile up while nobody listens would all open a session.
  if (next_hello_s) link.reconnect();
  send_message(Hello{k_protocol_version, options.client_name, options.scene_digest});
  next_hello_s = now_s + options.reconnect_interval_s * hello_backoff;
  // A daemon far away needs longer than one interval to answer.
  hello_backoff = std::min(2.0 * hello_backoff, k_longest_backoff);
}

void CullingSession::Impl::forget_views() {
  for (View& view : views) {
    view.sets.clear();
    view.in_flight.clear();
  }
}

void CullingSession::Impl::lose() {
  if (state == SessionState::open) {
    ++lost_count;
    link.reconnect();
  }
  state = SessionState::connecting;
  welcome.reset();
  forget_views();
  next_hello_s.reset();
  hello_backoff = 1.0;
}

void CullingSession::Impl::refuse(Refusal why) {
  if (state == SessionState::open) lose();
  state = SessionState::refused;
  refusal = std::move(why);
}

void CullingSession::Impl::on(const Welcome& message, double) {
  if (message.version != k_protocol_version) {
    refuse({RefusalReason::version_mismatch,
            "daemon speaks version " + std::to_string(message.version) + " of the protocol, this client " +
                std::to_string(k_protocol_version) + ": run the same release on both sides",
            message.version,
            {}});
    return;
  }
  if (options.object_count != 0 && message.object_count != options.object_count) {
    refuse({RefusalReason::scene_mismatch,
            "daemon has " + std::to_string(message.object_count) + " objects, this client " +
                std::to_string(options.object_count) + ": load the same scene on both sides",
            message.version,
            {}});
    return;
  }
  if (message.session_id == 0) {
    ++bad_frames;
    return;
  }
  if (welcome && welcome->session_id != message.session_id) {
    // The daemon began anew under our feet: whatever the old session knew is gone.
    ++lost_count;
    forget_views();
  }
  welcome = message;
  refusal.reset();
  state = SessionState::open;
  hello_backoff = 1.0;
}

void CullingSession::Impl::on(const Refusal& message, double now_s) {
  switch (message.reason) {
    case RefusalReason::version_mismatch:
    case RefusalReason::scene_mismatch:
      refuse(message);
      return;
    case RefusalReason::limit:
      lose();
      refusal = message;
      hello_backoff = k_longest_backoff;  // a place may come free, but hardly at once
      next_hello_s = now_s + options.reconnect_interval_s * hello_backoff;
      return;
    case RefusalReason::malformed:
      ++bad_frames;
      return;
    case RefusalReason::no_session:
      if (state == SessionState::open) lose();
      return;
    case RefusalReason::shutting_down:
      lose();
      next_hello_s = now_s + options.reconnect_interval_s;  // the daemon is going: not at once
      return;
  }
  // A newer daemon's reason, of which only this much is known.
  Refusal unknown = message;
  unknown.reason = RefusalReason::version_mismatch;
  refuse(std::move(unknown));
}

void CullingSession::Impl::on(VisibleSetFrame message, double) {
  if (state != SessionState::open || message.session_id != welcome->session_id)
    return;  // of a session long gone
  if (message.scene_digest != options.scene_digest) {
    ++bad_frames;
    return;
  }
  View& view = views[message.view];  // below k_max_views: the decoder saw to it
  std::optional<VisibleSet> set = view.sets.decode(message, welcome->object_count);
  if (!set) {
    ++bad_frames;
    return;
  }
  auto asked = view.in_flight.take(message.request_seq);
  if (!asked) return;
  message.bitmap.clear();
  message.extents_of.clear();
  message.extents.clear();
  answers.push_back({std::move(asked->request), asked->issued_s, std::move(*set), std::move(message)});
}

void CullingSession::Impl::on(const WhyAnswer& message, double) {
  if (state != SessionState::open || message.session_id != welcome->session_id) return;
  why_answers.push_back(message);
}

CullingSession::CullingSession(SessionOptions options) : impl_(std::make_unique<Impl>(std::move(options))) {}

CullingSession::~CullingSession() {
  try {
    if (impl_->welcome) impl_->send_message(Goodbye{impl_->welcome->session_id});
  } catch (...) {  // the daemon reaps the session by its silence
  }
}

std::vector<Answer> CullingSession::poll(double now_s) {
  impl_->step(now_s);
  return std::exchange(impl_->answers, {});
}

bool CullingSession::send(ViewRequest request, double now_s) {
  if (impl_->state != SessionState::open) return false;
  request.session_id = impl_->welcome->session_id;
  Impl::View& view = impl_->views.at(request.view);
  request.acked_set_seq = view.sets.acked_seq();
  Message message(std::move(request));
  if (!impl_->link.send(encode(message))) return false;
  view.in_flight.add(std::get<ViewRequest>(std::move(message)), now_s);
  return true;
}

bool CullingSession::send_why(std::uint64_t nonce, std::uint8_t view, ObjectId id) {
  if (impl_->state != SessionState::open) return false;
  return impl_->link.send(encode(Why{impl_->welcome->session_id, nonce, view, id}));
}

std::vector<WhyAnswer> CullingSession::take_why_answers() {
  return std::exchange(impl_->why_answers, {});
}

void CullingSession::wait(double timeout_s) {
  const auto wait = std::chrono::milliseconds(static_cast<int>(std::clamp(timeout_s, 0.0, 1.0) * 1000.0) + 1);
  if (const auto frame = impl_->link.receive(wait)) impl_->take_frame(*frame, impl_->last_step_s);
}

void CullingSession::retry() {
  if (impl_->state != SessionState::refused) return;
  impl_->state = SessionState::connecting;
  impl_->refusal.reset();
  impl_->next_hello_s.reset();
  impl_->hello_backoff = 1.0;
}

std::optional<std::uint64_t> CullingSession::oldest_in_flight(std::uint8_t view) const noexcept {
  return view < k_max_views ? impl_->views[view].in_flight.oldest_seq() : std::nullopt;
}

std::optional<Answer> CullingSession::wait_for(std::uint64_t request_seq, double timeout_s,
                                               std::uint8_t view) {
  const Clock::time_point start = Clock::now();
  while (true) {
    auto& answers = impl_->answers;
    const auto found = std::find_if(answers.begin(), answers.end(), [&](const Answer& answer) {
      return answer.request.request_seq == request_seq && answer.request.view == view;
    });
    if (found != answers.end()) {
      Answer answer = std::move(*found);
      answers.erase(found);
      return answer;
    }
    if (impl_->state != SessionState::open) return {};
    const double left_s = timeout_s - seconds_since(start);
    if (!(left_s > 0.0)) {
      impl_->silence_s += std::max(timeout_s, 0.0);  // all of it spent listening
      return {};
    }
    const auto wait = std::chrono::milliseconds(static_cast<int>(std::min(left_s, 1.0) * 1000.0) + 1);
    if (const auto frame = impl_->link.receive(wait)) impl_->take_frame(*frame, impl_->last_step_s);
  }
}

SessionState CullingSession::wait_until_open(double timeout_s) {
  const Clock::time_point start = Clock::now();
  const double begin_s = impl_->last_step_s;
  while (true) {
    impl_->step(begin_s + seconds_since(start));
    if (impl_->state != SessionState::connecting || seconds_since(start) >= timeout_s) break;
    const double left_s = timeout_s - seconds_since(start);
    const double wait_s = std::clamp(std::min(left_s, impl_->options.reconnect_interval_s), 0.0, 0.1);
    const auto wait = std::chrono::milliseconds(static_cast<int>(wait_s * 1000.0) + 1);
    if (const auto frame = impl_->link.receive(wait)) impl_->take_frame(*frame, impl_->last_step_s);
  }
  impl_->last_step_s = begin_s;
  return impl_->state;
}

SessionState CullingSession::state() const noexcept {
  return impl_->state;
}
const std::optional<Welcome>& CullingSession::welcome() const noexcept {
  return impl_->welcome;
}
const std::optional<Refusal>& CullingSession::refusal() const noexcept {
  return impl_->refusal;
}
std::uint64_t CullingSession::lost_count() const noexcept {
  return impl_->lost_count;
}
std::uint64_t CullingSession::bytes_sent() const noexcept {
  return impl_->link.bytes_sent();
}
std::uint64_t CullingSession::bytes_received() const noexcept {
  return impl_->link.bytes_received();
}
std::uint64_t CullingSession::bad_frame_count() const noexcept {
  return impl_->bad_frames;
}

}  // namespace sightline
