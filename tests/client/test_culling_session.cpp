#include <chrono>
#include <functional>
#include <thread>

#include <gtest/gtest.h>

#include "main_view/client/culling_session.hpp"
#include "tests/client/fake_daemon.hpp"

namespace sightline {
namespace {

using testing::FakeDaemon;

constexpr std::uint32_t k_object_count = 1000;
constexpr SceneDigest k_digest{1, 2, 3, 4, 5};

SessionOptions options_for(const std::string& endpoint) {
  SessionOptions options;
  options.endpoint = endpoint;
  options.scene_digest = k_digest;
  options.object_count = k_object_count;
  return options;
}

VisibleSet set_of(std::initializer_list<std::uint32_t> indices) {
  std::vector<ObjectId> ids;
  for (const std::uint32_t index : indices) ids.push_back(ObjectId{index});
  return VisibleSet(ids);
}

ViewRequest request_numbered(std::uint64_t seq) {
  ViewRequest request;
  request.request_seq = seq;
  request.for_time_s = static_cast<double>(seq);
  request.eyes.emplace_back();
  return request;
}

/// A session and a fake daemon, driven in turn. The session's clock runs four times as fast as the real one.
class CullingSessionOverLoopback : public ::testing::Test {
 protected:
  void SetUp() override {
    daemon_.emplace();
    session_.emplace(options_for(daemon_->endpoint()));
  }

  /// Polls the session as frames would until `done`, 10 real seconds at most.
  bool poll_until(const std::function<bool()>& done) {
    const auto start = std::chrono::steady_clock::now();
    const double start_s = now_s_;
    while (true) {
      const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
      now_s_ = start_s + 4.0 * passed.count();
      for (Answer& answer : session_->poll(now_s_)) answers_.push_back(std::move(answer));
      if (done()) return true;
      if (passed > std::chrono::seconds(10)) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));  // a frame's work
    }
  }

  template <typename T>
  std::optional<T> daemon_hears() {
    std::optional<T> message;
    poll_until([&] {
      message = daemon_->next<T>(std::chrono::milliseconds(1));
      return message.has_value();
    });
    return message;
  }

  void welcome(std::uint64_t session_id) {
    Welcome message;
    message.session_id = session_id;
    message.object_count = k_object_count;
    // Every Hello, as a daemon does: on a busy machine the first may be of a connection already given up.
    ASSERT_TRUE(poll_until([&] {
      if (daemon_->next<Hello>()) daemon_->send(message);
      return session_->state() == SessionState::open && session_->welcome()->session_id == session_id;
    }));
  }

  VisibleSetFrame keyframe(std::uint64_t set_seq, std::uint64_t request_seq, const VisibleSet& set) {
    VisibleSetFrame frame;
    frame.session_id = session_->welcome()->session_id;
    frame.set_seq = set_seq;
    frame.request_seq = request_seq;
    frame.scene_digest = k_digest;
    frame.visible_count = static_cast<std::uint32_t>(set.size());
    frame.bitmap = encode_keyframe(set);
    return frame;
  }

  ViewRequest exchange(std::uint64_t seq) {
    EXPECT_TRUE(session_->send(request_numbered(seq), now_s_));
    const auto heard = daemon_hears<ViewRequest>();
    return heard ? *heard : ViewRequest{};
  }

  bool bad_frame_arrives(std::uint64_t count) {
    return poll_until([&] { return session_->bad_frame_count() >= count; });
  }

  std::optional<FakeDaemon> daemon_;
  std::optional<CullingSession> session_;
  std::vector<Answer> answers_;
  double now_s_ = 100.0;
};

TEST_F(CullingSessionOverLoopback, OpensWithAHelloThatNamesVersionAndScene) {
  EXPECT_EQ(session_->state(), SessionState::connecting);
  EXPECT_FALSE(session_->send(request_numbered(1), now_s_));
  welcome(77);
  const auto& hello = std::get<Hello>(daemon_->heard.front());
  EXPECT_EQ(hello.version, k_protocol_version);
  EXPECT_EQ(hello.scene_digest, k_digest);
  EXPECT_EQ(session_->welcome()->session_id, 77u);
  EXPECT_EQ(session_->lost_count(), 0u);
}

TEST_F(CullingSessionOverLoopback, HandsOutTheSetWithTheRequestItAnswers) {
  welcome(77);
  const ViewRequest heard = exchange(1);
  EXPECT_EQ(heard.session_id, 77u);
  EXPECT_EQ(heard.acked_set_seq, 0u);
  const double issued_s = now_s_;
  daemon_->send(keyframe(1, 1, set_of({3, 999})));
  ASSERT_TRUE(poll_until([&] { return !answers_.empty(); }));
  EXPECT_EQ(answers_[0].request.request_seq, 1u);
  EXPECT_EQ(answers_[0].set, set_of({3, 999}));
  EXPECT_LE(answers_[0].issued_s, issued_s);
  EXPECT_EQ(exchange(2).acked_set_seq, 1u);
}

TEST_F(CullingSessionOverLoopback, WaitsForTheAnswerItIsAskedFor) {
  welcome(77);
  exchange(1);
  exchange(2);
  daemon_->send(keyframe(1, 1, set_of({1})));
  daemon_->send(keyframe(2, 2, set_of({2})));
  const auto answer = session_->wait_for(2, 10.0);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->set, set_of({2}));
  const auto earlier = session_->poll(now_s_);
  ASSERT_EQ(earlier.size(), 1u);
  EXPECT_EQ(earlier[0].set, set_of({1}));
  EXPECT_FALSE(session_->wait_for(3, 0.01));
}

TEST_F(CullingSessionOverLoopback, AppliesDeltasToTheSetTheyAreAgainst) {
  welcome(77);
  exchange(1);
  daemon_->send(keyframe(1, 1, set_of({1, 2, 3})));
  ASSERT_TRUE(poll_until([&] { return answers_.size() == 1; }));
  exchange(2);
  VisibleSetFrame delta = keyframe(2, 2, set_of({2, 3, 4}));
  delta.base_seq = 1;
  delta.bitmap = encode_delta(set_of({1, 2, 3}), set_of({2, 3, 4}));
  daemon_->send(delta);
  ASSERT_TRUE(poll_until([&] { return answers_.size() == 2; }));
  EXPECT_EQ(answers_[1].set, set_of({2, 3, 4}));
}

TEST_F(CullingSessionOverLoopback, AsksForAKeyframeWhenADeltasBaseIsMissing) {
  welcome(77);
  exchange(1);
  daemon_->send(keyframe(1, 1, set_of({1})));
  ASSERT_TRUE(poll_until([&] { return answers_.size() == 1; }));
  EXPECT_EQ(exchange(2).acked_set_seq, 1u);
  VisibleSetFrame delta = keyframe(9, 2, set_of({1, 2}));
  delta.base_seq = 8;
  delta.bitmap = encode_delta(set_of({1}), set_of({1, 2}));
  daemon_->send(delta);
  ASSERT_TRUE(bad_frame_arrives(1));
  EXPECT_EQ(answers_.size(), 1u);
  EXPECT_EQ(exchange(3).acked_set_seq, 0u);
  daemon_->send(keyframe(10, 3, set_of({5})));
  ASSERT_TRUE(poll_until([&] { return answers_.size() == 2; }));
  EXPECT_EQ(exchange(4).acked_set_seq, 10u);
}

TEST_F(CullingSessionOverLoopback, StaysRefusedAndSaysWhy) {
  for (const RefusalReason reason : {RefusalReason::version_mismatch, RefusalReason::scene_mismatch}) {
    session_.emplace(options_for(daemon_->endpoint()));
    ASSERT_TRUE(daemon_hears<Hello>());
    daemon_->send(Refusal{reason, "because", 2, {}});
    ASSERT_TRUE(poll_until([&] { return session_->state() == SessionState::refused; }));
    EXPECT_EQ(session_->refusal()->text, "because");
    Welcome late;
    late.session_id = 5;
    late.object_count = k_object_count;
    daemon_->send(late);
    const double until_s = now_s_ + 2.0;
    poll_until([&] { return now_s_ > until_s; });
    EXPECT_EQ(session_->state(), SessionState::refused);
    EXPECT_EQ(session_->wait_until_open(0.01), SessionState::refused);
  }
}

TEST_F(CullingSessionOverLoopback, TakesAReasonOfANewerDaemonForAnotherVersion) {
  ASSERT_TRUE(daemon_hears<Hello>());
  daemon_->send(Refusal{static_cast<RefusalReason>(77), "because", k_protocol_version + 1, {}});
  ASSERT_TRUE(poll_until([&] { return session_->state() == SessionState::refused; }));
  EXPECT_EQ(session_->refusal()->reason, RefusalReason::version_mismatch);
  EXPECT_EQ(session_->refusal()->text, "because");
}

TEST_F(CullingSessionOverLoopback, AsksAFullDaemonAgainAfterAPause) {
  ASSERT_TRUE(daemon_hears<Hello>());
  daemon_->send(Refusal{RefusalReason::limit, "full", k_protocol_version, {}});
  ASSERT_TRUE(poll_until([&] { return session_->refusal().has_value(); }));
  EXPECT_EQ(session_->state(), SessionState::connecting);
  EXPECT_EQ(session_->refusal()->text, "full");
  while (daemon_->next<Hello>()) continue;  // of before
  const double refused_s = now_s_;
  ASSERT_TRUE(daemon_hears<Hello>());
  EXPECT_GE(now_s_ - refused_s, 0.9);
  welcome(77);
  EXPECT_FALSE(session_->refusal());
  EXPECT_EQ(session_->lost_count(), 0u);
}

TEST_F(CullingSessionOverLoopback, RefusesADaemonWithAnotherNumberOfObjects) {
  ASSERT_TRUE(daemon_hears<Hello>());
  Welcome message;
  message.session_id = 5;
  message.object_count = k_object_count + 1;
  daemon_->send(message);
  ASSERT_TRUE(poll_until([&] { return session_->state() == SessionState::refused; }));
  EXPECT_EQ(session_->refusal()->reason, RefusalReason::scene_mismatch);
}

TEST_F(CullingSessionOverLoopback, RefusesADaemonOfAnotherVersion) {
  ASSERT_TRUE(daemon_hears<Hello>());
  Welcome message;
  message.version = k_protocol_version + 1;
  message.session_id = 5;
  message.object_count = k_object_count;
  daemon_->send(message);
  ASSERT_TRUE(poll_until([&] { return session_->state() == SessionState::refused; }));
  EXPECT_EQ(session_->refusal()->reason, RefusalReason::version_mismatch);
}

TEST_F(CullingSessionOverLoopback, SaysHelloAgainWhenTheDaemonKnowsNoSession) {
  welcome(77);
  exchange(1);
  daemon_->send(Refusal{RefusalReason::no_session, "who are you", k_protocol_version, {}});
  welcome(78);
  EXPECT_EQ(session_->lost_count(), 1u);
  EXPECT_EQ(exchange(2).acked_set_seq, 0u);
}

TEST_F(CullingSessionOverLoopback, TakesSilenceForALossAndComesBackWithTheDaemon) {
  welcome(77);
  const std::string endpoint = daemon_->endpoint();
  daemon_.reset();
  ASSERT_TRUE(poll_until([&] { return session_->state() == SessionState::connecting; }));
  EXPECT_EQ(session_->lost_count(), 1u);
  EXPECT_FALSE(session_->welcome());
  daemon_.emplace(endpoint);
  welcome(78);
  EXPECT_EQ(session_->lost_count(), 1u);
  exchange(1);
  daemon_->send(keyframe(1, 1, set_of({1})));
  EXPECT_TRUE(poll_until([&] { return answers_.size() == 1; }));
}

TEST_F(CullingSessionOverLoopback, StaysOpenWhileTheDaemonAnswersPings) {
  welcome(77);
  const double until_s = now_s_ + 3.0;
  int pings = 0;
  ASSERT_TRUE(poll_until([&] {
    if (const auto ping = daemon_->next<Ping>(std::chrono::milliseconds(1))) {
      ++pings;
      daemon_->send(Pong{ping->nonce, ping->time_s});
    }
    return now_s_ > until_s;
  }));
  EXPECT_GT(pings, 3);
  EXPECT_EQ(session_->state(), SessionState::open);
  EXPECT_EQ(session_->lost_count(), 0u);
}

TEST_F(CullingSessionOverLoopback, DoesNotTakeItsOwnPauseForTheDaemonsSilence) {
  welcome(77);
  now_s_ += 100.0;
  EXPECT_TRUE(session_->poll(now_s_).empty());
  EXPECT_EQ(session_->state(), SessionState::open);
}

TEST_F(CullingSessionOverLoopback, AnswersPings) {
  welcome(77);
  daemon_->send(Ping{42, 1.5});
  const auto pong = daemon_hears<Pong>();
  ASSERT_TRUE(pong);
  EXPECT_EQ(pong->nonce, 42u);
  EXPECT_EQ(pong->time_s, 1.5);
}

TEST_F(CullingSessionOverLoopback, DropsFramesThatLie) {
  welcome(77);
  exchange(1);
  const VisibleSetFrame good = keyframe(1, 1, set_of({1, 2}));
  std::uint64_t bad = 0;
  daemon_->send_raw({});
  daemon_->send_raw(Bytes(100, std::byte{0x5a}));
  Bytes truncated = encode(Message(good));
  truncated.resize(truncated.size() / 2);
  daemon_->send_raw(truncated);
  VisibleSetFrame lie = good;
  lie.visible_count = 3;
  daemon_->send(lie);
  lie = good;
  lie.bitmap = encode_keyframe(set_of({1, k_object_count}));
  daemon_->send(lie);
  lie = good;
  lie.scene_digest = {9};
  daemon_->send(lie);
  daemon_->send(Hello{});  // not a daemon's to say
  bad = 6;                 // ZeroMQ may swallow the empty frame
  ASSERT_TRUE(bad_frame_arrives(bad));
  EXPECT_TRUE(answers_.empty());
  EXPECT_EQ(session_->state(), SessionState::open);
  daemon_->send(good);
  EXPECT_TRUE(poll_until([&] { return answers_.size() == 1; }));
}

TEST_F(CullingSessionOverLoopback, IgnoresSetsOfAnotherSessionOrOfNoRequest) {
  welcome(77);
  exchange(1);
  VisibleSetFrame other = keyframe(1, 1, set_of({1}));
  other.session_id = 5;
  daemon_->send(other);
  daemon_->send(keyframe(2, 999, set_of({1})));
  daemon_->send(keyframe(3, 1, set_of({7})));
  ASSERT_TRUE(poll_until([&] { return !answers_.empty(); }));
  EXPECT_EQ(answers_.size(), 1u);
  EXPECT_EQ(answers_[0].set, set_of({7}));
}

TEST_F(CullingSessionOverLoopback, KeepsTheViewsRequestsSetsAndAcknowledgementsApart) {
  welcome(77);
  ViewRequest mirror = request_numbered(1);
  mirror.view = 3;
  exchange(1);
  ASSERT_TRUE(session_->send(mirror, now_s_));
  EXPECT_EQ(session_->oldest_in_flight(0), 1u);
  EXPECT_EQ(session_->oldest_in_flight(3), 1u);
  VisibleSetFrame of_mirror = keyframe(1, 1, set_of({8, 9}));
  of_mirror.view = 3;
  daemon_->send(of_mirror);
  daemon_->send(keyframe(1, 1, set_of({5})));  // the same numbers, of the other view
  ASSERT_TRUE(poll_until([&] { return answers_.size() == 2; }));
  EXPECT_EQ(answers_[0].request.view, 3u);
  EXPECT_EQ(answers_[0].set, set_of({8, 9}));
  EXPECT_EQ(answers_[1].request.view, 0u);
  EXPECT_EQ(answers_[1].set, set_of({5}));
  EXPECT_FALSE(session_->oldest_in_flight(0));

  mirror.request_seq = 2;
  ASSERT_TRUE(session_->send(mirror, now_s_));
  ASSERT_TRUE(daemon_hears<ViewRequest>());  // the first of the view
  const auto asked = daemon_hears<ViewRequest>();
  ASSERT_TRUE(asked);
  EXPECT_EQ(asked->acked_set_seq, 1u);
  VisibleSetFrame delta = keyframe(2, 2, set_of({9}));
  delta.view = 3;
  delta.base_seq = 1;
  delta.bitmap = encode_delta(set_of({8, 9}), set_of({9}));
  daemon_->send(delta);
  ASSERT_TRUE(poll_until([&] { return answers_.size() == 3; }));
  EXPECT_EQ(answers_[2].set, set_of({9}));
}

TEST_F(CullingSessionOverLoopback, SaysHelloAgainWhenItIsTold) {
  ASSERT_TRUE(poll_until([&] { return daemon_->next<Hello>().has_value(); }));
  daemon_->send(Refusal{RefusalReason::scene_mismatch, "no such scene", k_protocol_version, {}});
  ASSERT_TRUE(poll_until([&] { return session_->state() == SessionState::refused; }));
  session_->retry();
  EXPECT_EQ(session_->state(), SessionState::connecting);
  welcome(78);
  session_->retry();  // open: nothing to be done again
  EXPECT_EQ(session_->state(), SessionState::open);
}

TEST_F(CullingSessionOverLoopback, AsksWhyAndHandsOutWhatItsSessionIsTold) {
  EXPECT_FALSE(session_->send_why(5, 0, ObjectId{7}));
  welcome(77);
  ASSERT_TRUE(session_->send_why(5, 2, ObjectId{7}));
  const auto asked = daemon_hears<Why>();
  ASSERT_TRUE(asked);
  EXPECT_EQ(*asked, (Why{77, 5, 2, ObjectId{7}}));
  WhyAnswer answer;
  answer.session_id = 5;
  answer.state = WhyState::hidden;
  daemon_->send(answer);  // of another session
  answer.session_id = 77;
  answer.nonce = 5;
  daemon_->send(answer);
  std::vector<WhyAnswer> answers;
  ASSERT_TRUE(poll_until([&] {
    answers = session_->take_why_answers();
    return !answers.empty();
  }));
  EXPECT_EQ(answers, std::vector<WhyAnswer>{answer});
}

TEST(CullingSession, ReturnsInTimeWhenNobodyListens) {
  std::string endpoint;
  {
    const FakeDaemon gone;
    endpoint = gone.endpoint();
  }
  CullingSession session(options_for(endpoint));
  EXPECT_EQ(session.wait_until_open(0.3), SessionState::connecting);
  EXPECT_EQ(session.lost_count(), 0u);
}

}  // namespace
}  // namespace sightline
