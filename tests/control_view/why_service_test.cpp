// Questions why on the wire: answered at the session's turn, few a second, to the peer that asked alone.

#include <gtest/gtest.h>

#include "tests/control_view/test_client.hpp"

namespace sightline {
namespace {

using test::Client;
using test::Daemon;
using test::k_object_count;

Why question_of(const Client& client, std::uint64_t nonce, std::uint32_t id, std::uint8_t view = 0) {
  return {client.session_id, nonce, view, ObjectId{id}};
}

TEST(WhyOnTheWire, IsUnknownBeforeTheFirstAnswerAndCopiesTheQuestion) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  client.send(question_of(client, 41, 7, 3));
  const auto answer = client.next_as<WhyAnswer>();
  EXPECT_EQ(answer.session_id, client.session_id);
  EXPECT_EQ(answer.nonce, 41u);
  EXPECT_EQ(answer.view, 3u);
  EXPECT_EQ(answer.object_id, ObjectId{7});
  EXPECT_EQ(answer.state, WhyState::unknown);
}

TEST(WhyOnTheWire, FollowsTheNewestSetOfItsView) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  const VisibleSet here = client.ask(client.request(1, 1.0));
  ViewRequest elsewhere = client.request(1, 9.0);
  elsewhere.view = 1;
  const VisibleSet there = client.ask(elsewhere);
  for (std::uint32_t id = 0; id < 40; ++id) {
    for (const std::uint8_t view : {0, 1}) {
      const bool in_set = (view == 0 ? here : there).contains(ObjectId{id});
      daemon.now_s += 1.0;
      client.send(question_of(client, id, id, view));
      const auto answer = client.next_as<WhyAnswer>();
      EXPECT_EQ(answer.state, in_set ? WhyState::visible : WhyState::hidden) << id;
      EXPECT_EQ(answer.request_seq, 1u);
      EXPECT_EQ(answer.pixels > 0, in_set);
    }
  }
}

TEST(WhyOnTheWire, KnowsWhatTheClientSaidIsGoneOrMoves) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  ViewRequest request = client.request(1, 1.0);
  request.presence = {{ObjectId{12}, false}};
  request.boxed = {{ObjectId{20}, {{-1, -1, -6}, {1, 1, -5}}}};
  (void)client.ask(request);
  client.send(question_of(client, 1, 12));
  EXPECT_EQ(client.next_as<WhyAnswer>().state, WhyState::absent);
  client.send(question_of(client, 2, 20));
  EXPECT_EQ(client.next_as<WhyAnswer>().state, WhyState::boxed);
}

TEST(WhyOnTheWire, ThoseBeyondTwentyASecondAreDropped) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  for (std::uint64_t nonce = 1; nonce <= 200; ++nonce) client.send(question_of(client, nonce, 1));
  client.send(Ping{5, 0.0});
  bool ponged = false;
  std::uint64_t newest = 0;
  // Of a burst of answers the link drops some; those that come are in order.
  const auto read = [&] {
    while (const auto message = client.poll()) {
      ponged = ponged || std::holds_alternative<Pong>(*message);
      if (!std::holds_alternative<WhyAnswer>(*message)) continue;
      EXPECT_GT(std::get<WhyAnswer>(*message).nonce, newest);
      newest = std::get<WhyAnswer>(*message).nonce;
    }
  };
  const auto most = static_cast<std::uint64_t>(WhyQueue::k_a_second);
  EXPECT_TRUE(daemon.run_until([&] {
    read();
    return ponged && daemon.service.counters().explained >= most;
  }));
  daemon.now_s += 1.0;
  client.send(question_of(client, 999, 1));
  EXPECT_TRUE(daemon.run_until([&] {
    read();
    return newest == 999;
  }));
  EXPECT_EQ(daemon.service.counters().explained, most + 1);
}

TEST(WhyOnTheWire, IsRefusedForAnotherSessionOrAnObjectThatIsNotThere) {
  Daemon daemon;
  Client client(daemon), other(daemon);
  client.send(Why{5, 1, 0, ObjectId{1}});
  EXPECT_EQ(client.next_as<Refusal>().reason, RefusalReason::no_session);
  client.open();
  other.open();
  Why of_other = question_of(other, 1, 1);
  client.send(of_other);
  EXPECT_EQ(client.next_as<Refusal>().reason, RefusalReason::no_session);
  client.send(question_of(client, 1, k_object_count));
  EXPECT_EQ(client.next_as<Refusal>().reason, RefusalReason::malformed);
  client.send(question_of(client, 2, k_object_count - 1));
  EXPECT_EQ(client.next_as<WhyAnswer>().nonce, 2u) << "and the session goes on";
}

TEST(WhyOnTheWire, AnAnswerIsNoQuestion) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  client.send(WhyAnswer{client.session_id, 1, 0, ObjectId{1}, 1, WhyState::visible, 1, 1.0, 0.0, {}});
  EXPECT_EQ(client.next_as<Refusal>().reason, RefusalReason::malformed);
}

}  // namespace
}  // namespace sightline
