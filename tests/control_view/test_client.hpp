#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include <gtest/gtest.h>

#include "control_view/service.hpp"
#include "protocol/codec.hpp"
#include "protocol/endpoint_link.hpp"
#include "protocol/visible_set.hpp"
#include "tests/control_view/fake_engine.hpp"

namespace sightline::test {

inline constexpr SceneDigest k_digest{1, 2, 3, 4};
inline constexpr std::chrono::milliseconds k_slice{2};
inline constexpr double k_deadline_s = 10.0;

/// A service over a fake engine, on loopback, with a clock that stands still unless turned.
struct Daemon {
  explicit Daemon(ServiceOptions options = default_options())
      : scenes(served_scene({k_digest, k_object_count}, std::make_unique<FakeEngine>())),
        engine(static_cast<FakeEngine&>(*scenes.own()->engine)),
        service(link, scenes, nullptr, std::move(options), [this] { return now_s; }) {}

  static ServiceOptions default_options() {
    ServiceOptions options;
    options.pipeline = {{100, 80}, 1, 0.0, false};
    options.max_sessions = 4;
    return options;
  }

  /// Lets the service run until `done`, at most k_deadline_s of real time.
  template <class Condition>
  bool run_until(Condition done) {
    const Clock clock = steady_clock();
    for (const double end_s = clock() + k_deadline_s; clock() < end_s;) {
      if (done()) return true;
      service.step(k_slice);
    }
    return done();
  }

  double now_s = 1000.0;
  SceneStore scenes;
  FakeEngine& engine;
  ServerLink link{"tcp://127.0.0.1:*"};
  Service service;
};

/// A client that keeps the sets it was sent.
class Client {
 public:
  explicit Client(Daemon& daemon) : daemon_(daemon), link_(daemon.link.bound_endpoint(), roomy()) {}

  void send(const Message& message) { ASSERT_TRUE(link_.send(encode(message))); }
  void send_bytes(const Bytes& bytes) { ASSERT_TRUE(link_.send(bytes)); }

  /// The next message for this client, while the daemon runs. Fails the test when none comes.
  Message next() {
    std::optional<Message> message;
    daemon_.run_until([&] { return (message = poll()).has_value(); });
    if (!message) {
      ADD_FAILURE() << "the daemon did not answer";
      return Pong{};
    }
    return *message;
  }

  template <class Expected>
  Expected next_as() {
    Message message = next();
    if (auto* expected = std::get_if<Expected>(&message)) return *expected;
    ADD_FAILURE() << "another message came, number " << message.index();
    return {};
  }

  std::optional<Message> poll() {
    const auto frame = link_.receive(std::chrono::milliseconds{0});
    if (!frame) return {};
    auto decoded = decode(*frame);
    if (auto* error = std::get_if<DecodeError>(&decoded)) {
      ADD_FAILURE() << error->reason;
      return {};
    }
    return std::get<Message>(decoded);
  }

  /// Every frame sent before has been read by the daemon once this returns.
  void settle() {
    send(Ping{++nonce_, 0.0});
    EXPECT_EQ(next_as<Pong>().nonce, nonce_);
  }

  void open() {
    send(Hello{k_protocol_version, "test", k_digest});
    session_id = next_as<Welcome>().session_id;
    EXPECT_NE(session_id, 0u);
  }

  ViewRequest request(std::uint64_t seq, double place) const {
    ViewRequest view;
    view.session_id = session_id;
    view.request_seq = seq;
    view.for_time_s = 0.25 * static_cast<double>(seq);
    view.eyes = {eye_at(place)};
    return view;
  }

  /// Turns a frame back into its set and files it.
  VisibleSet set_of(const VisibleSetFrame& frame) {
    const auto base = sets.find(frame.base_seq);
    auto decoded = decode_visible_set(frame, base == sets.end() ? nullptr : &base->second, k_object_count);
    if (auto* error = std::get_if<DecodeError>(&decoded)) {
      ADD_FAILURE() << error->reason;
      return {};
    }
    return sets[frame.set_seq] = std::get<VisibleSet>(decoded);
  }

  VisibleSet ask(const ViewRequest& view) {
    send(view);
    const auto frame = next_as<VisibleSetFrame>();
    EXPECT_EQ(frame.request_seq, view.request_seq);
    last_frame = frame;
    return set_of(frame);
  }

  std::uint64_t session_id = 0;
  std::map<std::uint64_t, VisibleSet> sets;
  VisibleSetFrame last_frame;

 private:
  /// Room for the bursts of the tests.
  static LinkOptions roomy() {
    LinkOptions options;
    options.send_queue_length = 1000;
    return options;
  }

  Daemon& daemon_;
  ClientLink link_;
  std::uint64_t nonce_ = 0;
};

inline VisibleSet seen_from(double place) {
  return VisibleSet(ids_of(seed_of(place, {})));
}

}  // namespace sightline::test
