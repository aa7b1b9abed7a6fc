#include "control_view/service.hpp"

#include <random>
#include <string>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "tests/control_view/test_client.hpp"

namespace sightline {
namespace {

using test::Client;
using test::Daemon;
using test::ids_of;
using test::k_digest;
using test::k_object_count;
using test::seen_from;

ObjectMove move_of(std::uint32_t id, double x) {
  ObjectMove move{ObjectId{id}, glm::dmat4x3(1.0)};
  move.world_from_object[3][0] = x;
  return move;
}

TEST(ServiceHandshake, WelcomesAClientOfTheSameSceneAndVersion) {
  Daemon daemon;
  Client client(daemon);
  client.send(Hello{k_protocol_version, "test", k_digest});
  const auto welcome = client.next_as<Welcome>();
  EXPECT_NE(welcome.session_id, 0u);
  EXPECT_EQ(welcome.object_count, k_object_count);
  EXPECT_EQ(welcome.control_size, (ImageSize{100, 80}));
  EXPECT_EQ(welcome.filter_length, 1u);
}

TEST(ServiceHandshake, TellsTheSettingsInForce) {
  ServiceOptions options = Daemon::default_options();
  options.pipeline.threshold_pixels = 2.5;
  options.pipeline.refine = true;
  options.answer_rate_hz = 60.0;
  options.counter_name = "queries";
  options.preset_name = "avango";
  Daemon daemon(options);
  Client client(daemon);
  client.send(Hello{k_protocol_version, "test", k_digest});
  const auto welcome = client.next_as<Welcome>();
  EXPECT_EQ(welcome.engine, "item_buffer");
  EXPECT_EQ(welcome.counter, "queries");
  EXPECT_EQ(welcome.threshold, 2.5);
  EXPECT_EQ(welcome.control_rate_hz, 60.0);
  EXPECT_EQ(welcome.preset, "avango");
  EXPECT_TRUE(welcome.refine);
}

TEST(ServiceHandshake, RefusesAnotherVersion) {
  Daemon daemon;
  Client client(daemon);
  client.send(Hello{k_protocol_version + 1, "test", k_digest});
  const auto refusal = client.next_as<Refusal>();
  EXPECT_EQ(refusal.reason, RefusalReason::version_mismatch);
  EXPECT_EQ(refusal.server_version, k_protocol_version);
  EXPECT_EQ(daemon.service.session_count(), 0u);
}

TEST(ServiceHandshake, RefusesAnotherSceneAndSaysWhichItServes) {
  Daemon daemon;
  Client client(daemon);
  client.send(Hello{k_protocol_version, "test", SceneDigest{9}});
  const auto refusal = client.next_as<Refusal>();
  EXPECT_EQ(refusal.reason, RefusalReason::scene_mismatch);
  EXPECT_EQ(refusal.server_scene_digest, k_digest);
}

TEST(ServiceHandshake, RefusesOneClientTooMany) {
  Daemon daemon;
  std::vector<std::unique_ptr<Client>> clients;
  for (int i = 0; i < 4; ++i) {
    clients.push_back(std::make_unique<Client>(daemon));
    clients.back()->open();
  }
  Client late(daemon);
  late.send(Hello{k_protocol_version, "late", k_digest});
  EXPECT_EQ(late.next_as<Refusal>().reason, RefusalReason::limit);
  clients[0]->send(Goodbye{clients[0]->session_id});
  clients[0]->settle();
  late.open();
}

TEST(ServiceHandshake, ReplacesTheSessionOfAPeerThatSaysHelloAgain) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  const std::uint64_t earlier = client.session_id;
  client.open();
  EXPECT_NE(client.session_id, earlier);
  EXPECT_EQ(daemon.service.session_count(), 1u);
  ViewRequest old = client.request(1, 1.0);
  old.session_id = earlier;
  client.send(old);
  EXPECT_EQ(client.next_as<Refusal>().reason, RefusalReason::no_session);
}

TEST(ServiceHandshake, AnswersAPingWithoutASession) {
  Daemon daemon;
  Client client(daemon);
  client.send(Ping{77, 1.5});
  const auto pong = client.next_as<Pong>();
  EXPECT_EQ(pong.nonce, 77u);
  EXPECT_EQ(pong.time_s, 1.5);
}

TEST(ServiceHandshake, RefusesARequestBeforeAHello) {
  Daemon daemon;
  Client client(daemon);
  client.session_id = 5;
  client.send(client.request(1, 1.0));
  EXPECT_EQ(client.next_as<Refusal>().reason, RefusalReason::no_session);
}

TEST(ServiceHandshake, RefusesAnotherPeersSession) {
  Daemon daemon;
  Client owner(daemon);
  Client thief(daemon);
  owner.open();
  thief.open();
  ViewRequest stolen = owner.request(1, 1.0);
  stolen.moves = {move_of(4321, 1.0)};
  thief.send(stolen);
  EXPECT_EQ(thief.next_as<Refusal>().reason, RefusalReason::no_session);
  thief.send(Goodbye{owner.session_id});
  thief.settle();
  EXPECT_EQ(owner.ask(owner.request(1, 2.0)), seen_from(2.0));
}

TEST(Service, AnswersWithTheRequestsOwnNumberAndTime) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  EXPECT_EQ(client.ask(client.request(7, 2.0)), seen_from(2.0));
  EXPECT_EQ(client.last_frame.session_id, client.session_id);
  EXPECT_EQ(client.last_frame.for_time_s, 1.75);
  EXPECT_EQ(client.last_frame.scene_digest, k_digest);
  EXPECT_EQ(client.last_frame.set_seq, 1u);
}

TEST(Service, AnswersABurstOnceByItsNewest) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  // With the daemon not running meanwhile, all of them wait in its queue.
  for (std::uint64_t seq = 1; seq <= 50; ++seq) client.send(client.request(seq, static_cast<double>(seq)));
  client.send(Ping{1, 0.0});
  // Whether TCP delivers the burst in one go is not ours to say; what counts is that nothing old follows
  // newer.
  std::uint64_t answers = 0;
  std::uint64_t newest = 0;
  while (newest != 50) {
    const Message message = client.next();
    if (const auto* frame = std::get_if<VisibleSetFrame>(&message)) {
      ++answers;
      EXPECT_GT(frame->request_seq, newest);
      newest = frame->request_seq;
    } else {
      ASSERT_TRUE(std::holds_alternative<Pong>(message));
    }
  }
  EXPECT_EQ(daemon.service.counters().answered, answers);
  EXPECT_EQ(daemon.service.counters().superseded, 50u - answers);
  EXPECT_LT(answers, 25u);
}

TEST(Service, KeepsTheMovesOfSupersededRequests) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  ViewRequest first = client.request(1, 1.0);
  first.moves = {move_of(4321, 1.0)};
  ViewRequest second = client.request(2, 2.0);
  second.moves = {move_of(17, 1.0), move_of(3, 1.0)};
  client.send(first);
  client.send(second);
  client.send(client.request(3, 3.0));
  VisibleSet last;
  for (std::uint64_t newest = 0; newest != 3;) {
    const auto frame = client.next_as<VisibleSetFrame>();
    last = client.set_of(frame);
    newest = frame.request_seq;
  }
  for (const std::uint32_t id : {3u, 17u, 4321u}) EXPECT_TRUE(last.contains(ObjectId{id}));
}

TEST(Service, KeepsTheResetOfASupersededRequest) {
  ServiceOptions options = Daemon::default_options();
  options.pipeline.filter_length = 8;
  options.answer_rate_hz = 1.0;  // the clock stands still: the second answer waits until we turn it
  Daemon daemon(options);
  Client client(daemon);
  client.open();
  (void)client.ask(client.request(1, 1.0));
  ViewRequest jump = client.request(2, 5.0);
  jump.reset_filter = true;
  client.send(jump);
  client.send(client.request(3, 6.0));
  client.settle();
  EXPECT_EQ(daemon.service.counters().superseded, 1u);
  daemon.now_s += 1.0;
  const auto frame = client.next_as<VisibleSetFrame>();
  EXPECT_EQ(frame.request_seq, 3u);
  EXPECT_EQ(client.set_of(frame), seen_from(6.0));
}

TEST(Service, ResetsTheFilterWhenAsked) {
  ServiceOptions options = Daemon::default_options();
  options.pipeline.filter_length = 8;
  Daemon daemon(options);
  Client client(daemon);
  client.open();
  (void)client.ask(client.request(1, 1.0));
  VisibleSet both = seen_from(1.0);
  both.unite(seen_from(2.0));
  EXPECT_EQ(client.ask(client.request(2, 2.0)), both);
  ViewRequest jump = client.request(3, 3.0);
  jump.reset_filter = true;
  EXPECT_EQ(client.ask(jump), seen_from(3.0));
}

TEST(Service, ResetsAFilterWithAThresholdWhenAnObjectJumpsAndNotWhenItMoves) {
  ServiceOptions options = Daemon::default_options();
  options.pipeline.filter_length = 8;
  options.pipeline.threshold_pixels = 0.05;
  Daemon daemon(options);
  Client client(daemon);
  client.open();
  const ObjectId moved{4321};
  const auto with_moved = [&](VisibleSet set) {
    set.unite(VisibleSet({&moved, 1}));
    return set;
  };
  (void)client.ask(client.request(1, 1.0));
  ViewRequest jump = client.request(2, 2.0);
  jump.moves = {move_of(4321, 5.0)};
  EXPECT_EQ(client.ask(jump), with_moved(seen_from(2.0))) << "what was seen before the jump is forgotten";
  ViewRequest step = client.request(3, 3.0);
  step.moves = {move_of(4321, 5.1)};
  VisibleSet both = seen_from(2.0);
  both.unite(seen_from(3.0));
  EXPECT_EQ(client.ask(step), with_moved(both)) << "a small step keeps the history";
  ViewRequest leap = client.request(4, 4.0);
  leap.moves = {move_of(4321, 9.0)};
  EXPECT_EQ(client.ask(leap), with_moved(seen_from(4.0)));
  ViewRequest without = client.request(5, 5.0);
  without.presence = {{ObjectId{17}, false}};
  EXPECT_EQ(client.ask(without), with_moved(seen_from(5.0)));
}

TEST(Service, KeepsAFilterWithoutThresholdWhenAnObjectJumps) {
  ServiceOptions options = Daemon::default_options();
  options.pipeline.filter_length = 8;
  Daemon daemon(options);
  Client client(daemon);
  client.open();
  const ObjectId moved{4321};
  (void)client.ask(client.request(1, 1.0));
  ViewRequest jump = client.request(2, 2.0);
  jump.moves = {move_of(4321, 5.0)};
  VisibleSet both = seen_from(1.0);
  both.unite(seen_from(2.0));
  both.unite(VisibleSet({&moved, 1}));
  EXPECT_EQ(client.ask(jump), both) << "one look shows what the object hid: no need to forget the others";
}

TEST(Service, PutsABoxedObjectIntoTheSetWhateverTheThreshold) {
  ServiceOptions options = Daemon::default_options();
  options.pipeline.filter_length = 8;
  options.pipeline.threshold_pixels = 100.0;  // nothing else is seen
  Daemon daemon(options);
  Client client(daemon);
  client.open();
  const ObjectId boxed{static_cast<std::uint32_t>(4321)};
  ViewRequest request = client.request(1, 1.0);
  request.boxed = {{boxed, {glm::dvec3(0.0), glm::dvec3(1.0)}}};
  EXPECT_EQ(client.ask(request), VisibleSet({&boxed, 1}));
  EXPECT_EQ(daemon.engine.last_boxed, request.boxed);
  EXPECT_EQ(client.ask(client.request(2, 1.0)), VisibleSet());
}

TEST(Service, HoldsTheAnswerRate) {
  ServiceOptions options = Daemon::default_options();
  options.answer_rate_hz = 10.0;
  Daemon daemon(options);
  Client client(daemon);
  client.open();
  (void)client.ask(client.request(1, 1.0));
  client.send(client.request(2, 2.0));
  client.settle();
  EXPECT_EQ(daemon.service.counters().answered, 1u);
  daemon.now_s += 0.05;
  client.settle();
  EXPECT_EQ(daemon.service.counters().answered, 1u);
  daemon.now_s += 0.06;
  EXPECT_EQ(client.next_as<VisibleSetFrame>().request_seq, 2u);
}

TEST(ServiceDeltas, DecodeToTheSameSetsAsKeyframes) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  std::mt19937 random(5);
  int deltas = 0;
  std::vector<ObjectMove> moves;
  for (std::uint64_t seq = 1; seq <= 60; ++seq) {
    // Now and then a leap; mostly the set grows by a moved object.
    const std::uint64_t leaps = seq / 10;
    const auto place = static_cast<double>(leaps);
    ViewRequest request = client.request(seq, place);
    request.moves = {move_of(static_cast<std::uint32_t>(random() % k_object_count), 1.0)};
    moves.push_back(request.moves[0]);
    if (seq % 7 != 0 && !client.sets.empty()) request.acked_set_seq = client.sets.rbegin()->first;
    VisibleSet expected = seen_from(place);
    for (const ObjectMove& move : moves) {
      const ObjectId id = move.id;
      expected.unite(VisibleSet({&id, 1}));
    }
    ASSERT_EQ(client.ask(request), expected) << "request " << seq;
    if (client.last_frame.base_seq != 0) ++deltas;
  }
  EXPECT_GT(deltas, 30);
}

TEST(ServiceDeltas, FallBackToAKeyframeForABaseThatIsNotHeld) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  for (std::uint64_t seq = 1; seq <= SentSets::k_capacity + 5; ++seq)
    (void)client.ask(client.request(seq, 1.0));
  for (const std::uint64_t acked : {1ull, 0ull, 1000ull, ~0ull}) {
    ViewRequest request = client.request(client.last_frame.request_seq + 1, 1.0);
    request.acked_set_seq = acked;
    EXPECT_EQ(client.ask(request), seen_from(1.0));
    EXPECT_EQ(client.last_frame.base_seq, 0u) << acked;
  }
}

TEST(ServiceDeltas, AreEmptyWhenNothingChanged) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  (void)client.ask(client.request(1, 1.0));
  ViewRequest request = client.request(2, 1.0);
  request.acked_set_seq = 1;
  EXPECT_EQ(client.ask(request), seen_from(1.0));
  EXPECT_EQ(client.last_frame.base_seq, 1u);
  EXPECT_LT(client.last_frame.bitmap.size(), 16u);
}

TEST(ServiceSessions, DoNotMix) {
  ServiceOptions options = Daemon::default_options();
  options.pipeline.filter_length = 8;
  Daemon daemon(options);
  Client left(daemon);
  Client right(daemon);
  left.open();
  right.open();
  VisibleSet left_seen;
  VisibleSet right_seen;
  for (std::uint64_t seq = 1; seq <= 4; ++seq) {
    const auto place = static_cast<double>(seq);
    ViewRequest moving = left.request(seq, place);
    moving.moves = {move_of(4321, 1.0)};
    left_seen.unite(seen_from(place));
    right_seen.unite(seen_from(-100.0 - place));
    VisibleSet with_move = left_seen;
    const ObjectId moved{4321};
    with_move.unite(VisibleSet({&moved, 1}));
    EXPECT_EQ(left.ask(moving), with_move);
    EXPECT_EQ(right.ask(right.request(seq, -100.0 - place)), right_seen);
  }
}

TEST(ServiceSessions, TakeTurns) {
  Daemon daemon;
  Client greedy(daemon);
  Client modest(daemon);
  greedy.open();
  modest.open();
  for (std::uint64_t seq = 1; seq <= 20; ++seq) {
    for (std::uint64_t i = 0; i < 5; ++i) greedy.send(greedy.request(seq * 10 + i, 1.0));
    EXPECT_EQ(modest.ask(modest.request(seq, static_cast<double>(seq))), seen_from(static_cast<double>(seq)));
  }
}

TEST(ServiceSessions, AreReapedInSilence) {
  Daemon daemon;
  Client silent(daemon);
  Client lively(daemon);
  silent.open();
  lively.open();
  for (int second = 0; second < 7; ++second) {
    daemon.now_s += 1.0;
    lively.settle();
  }
  EXPECT_EQ(daemon.service.session_count(), 1u);
  EXPECT_EQ(daemon.service.counters().reaped, 1u);
  EXPECT_FALSE(silent.poll().has_value()) << "nothing is sent to the dead";
  silent.send(silent.request(1, 1.0));
  EXPECT_EQ(silent.next_as<Refusal>().reason, RefusalReason::no_session);
  EXPECT_EQ(lively.ask(lively.request(1, 1.0)), seen_from(1.0));
}

TEST(ServiceSessions, EndWithGoodbye) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  client.send(Goodbye{client.session_id});
  client.settle();
  EXPECT_EQ(daemon.service.session_count(), 0u);
}

TEST(ServiceSessions, HearOfTheDaemonsEnd) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  daemon.service.shut_down();
  EXPECT_EQ(client.next_as<Refusal>().reason, RefusalReason::shutting_down);
  EXPECT_EQ(daemon.service.session_count(), 0u);
}

TEST(ServiceUnderAttack, RefusesMalformedFramesOnceASecondAndCountsThemAll) {
  Daemon daemon;
  Client attacker(daemon);
  const Bytes garbage(64, std::byte{0xa5});
  for (int i = 0; i < 100; ++i) attacker.send_bytes(garbage);
  EXPECT_EQ(attacker.next_as<Refusal>().reason, RefusalReason::malformed);
  attacker.settle();
  EXPECT_EQ(daemon.service.counters().malformed, 100u);
  EXPECT_EQ(daemon.service.counters().refused, 1u);
  daemon.now_s += 1.5;
  attacker.send_bytes(garbage);
  EXPECT_EQ(attacker.next_as<Refusal>().reason, RefusalReason::malformed);
}

TEST(ServiceUnderAttack, HarmsNobodyElse) {
  Daemon daemon;
  Client good(daemon);
  Client attacker(daemon);
  good.open();
  attacker.open();
  const Bytes valid = encode(attacker.request(1, 1.0));
  std::mt19937 random(99);
  for (std::uint64_t round = 1; round <= 40; ++round) {
    for (int i = 0; i < 10; ++i) {
      Bytes frame = valid;
      switch (random() % 4) {
        case 0:
          frame.resize(random() % frame.size());
          break;
        case 1:
          frame.resize(std::size_t{1} << 16, std::byte{0xff});
          break;
        case 2:
          for (std::byte& byte : frame) byte = static_cast<std::byte>(random());
          break;
        default:
          for (int flips = 0; flips < 4; ++flips) frame[random() % frame.size()] ^= std::byte{1};
          break;
      }
      attacker.send_bytes(frame);
    }
    const auto place = static_cast<double>(round);
    ASSERT_EQ(good.ask(good.request(round, place)), seen_from(place));
  }
  attacker.send_bytes(Bytes{});
  good.settle();
}

TEST(ServiceUnderAttack, DecodesNoLargeFrameOfAPeerWithoutASession) {
  Daemon daemon;
  Client stranger(daemon);
  ViewRequest large = stranger.request(1, 1.0);
  for (std::uint32_t id = 0; id < 1000; ++id) large.moves.push_back(move_of(id, 1.0));
  ASSERT_GT(encode(large).size(), 64u << 10);
  stranger.send(large);
  EXPECT_EQ(stranger.next_as<Refusal>().reason, RefusalReason::no_session);
  stranger.open();
  large.session_id = stranger.session_id;
  EXPECT_GE(stranger.ask(large).size(), 1000u) << "with a session it is a request like any other";
}

TEST(ServiceUnderAttack, TakesNoMoreMovesThanThereAreObjects) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  ViewRequest request = client.request(1, 1.0);
  for (std::uint32_t id = 0; id < k_object_count; ++id) {
    request.moves.push_back(move_of(id, 1.0));
    request.boxed.push_back({ObjectId{id}, {}});
    request.presence.push_back({ObjectId{id}, true});
  }
  EXPECT_LE(encode(request).size(), largest_frame_of_a_client(k_object_count));
  EXPECT_EQ(client.ask(request).size(), k_object_count);
  request.request_seq = 2;
  request.moves.push_back(move_of(0, 1.0));
  client.send(request);
  const auto refusal = client.next_as<Refusal>();
  EXPECT_EQ(refusal.reason, RefusalReason::malformed);
  EXPECT_NE(refusal.text.find("moves: 5001, at most 5000"), std::string::npos) << refusal.text;
}

TEST(ServiceUnderAttack, ReadsABoundedAmountBeforeItAnswers) {
  Daemon daemon;
  Client good(daemon);
  Client flood(daemon);
  good.open();
  // Half a frame limit each: a hundred of them are three bounds of a step.
  for (int i = 0; i < 100; ++i) flood.send_bytes(Bytes(32u << 10));
  good.send(good.request(1, 1.0));
  EXPECT_EQ(good.next_as<VisibleSetFrame>().request_seq, 1u);
  EXPECT_EQ(flood.next_as<Refusal>().reason, RefusalReason::malformed);
  flood.settle();
  EXPECT_EQ(daemon.service.counters().malformed, 100u) << "every frame is read in the end";
}

TEST(ServiceSessions, OutliveAnAbsenceOfTheDaemonItself) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  daemon.now_s += 60.0;
  daemon.service.step(test::k_slice);  // finds it silent, before its words have come
  EXPECT_EQ(daemon.service.session_count(), 1u);
  EXPECT_EQ(client.ask(client.request(1, 2.0)), seen_from(2.0));
  daemon.now_s += 4.0;
  daemon.service.step(test::k_slice);
  EXPECT_EQ(daemon.service.counters().reaped, 0u) << "what was missed before it spoke no longer counts";
}

TEST(ServiceUnderAttack, ReapsNobodyWhoseWordsItHasNotRead) {
  Daemon daemon;
  Client good(daemon);
  Client flood(daemon);
  good.open();
  for (int i = 0; i < 900; ++i) flood.send(Ping{1, 1.0});
  daemon.now_s += 6.0;  // above the silence limit, with frames waiting
  good.send(good.request(1, 1.0));
  EXPECT_EQ(good.next_as<VisibleSetFrame>().request_seq, 1u);
  EXPECT_EQ(daemon.service.counters().reaped, 0u);
}

TEST(ServiceUnderAttack, RefusesMovesOfObjectsThatAreNotThere) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  const ObjectId absent{k_object_count};
  ViewRequest moves = client.request(1, 1.0), boxed = moves, presence = moves;
  moves.moves = {move_of(k_object_count, 0.0)};
  boxed.boxed = {{ObjectId{1}, {}}, {absent, {}}};
  presence.presence = {{absent, false}};
  for (const ViewRequest& request : {moves, boxed, presence}) {
    daemon.now_s += 2.0;  // one such refusal a second
    client.send(request);
    EXPECT_EQ(client.next_as<Refusal>().reason, RefusalReason::malformed);
  }
  EXPECT_EQ(client.ask(client.request(2, 2.0)), seen_from(2.0));
}

TEST(ServiceUnderAttack, RefusesMessagesThatOnlyADaemonSends) {
  Daemon daemon;
  Client client(daemon);
  Welcome welcome;
  welcome.session_id = 1;
  welcome.object_count = 1;
  welcome.control_size = {1, 1};
  client.send(welcome);
  const auto refusal = client.next_as<Refusal>();
  EXPECT_EQ(refusal.reason, RefusalReason::malformed);
  EXPECT_NE(refusal.text.find("only a daemon"), std::string::npos) << refusal.text;
}

TEST(ServiceUnderAttack, ClosesOnlyTheSessionWhoseRequestCannotBeAnswered) {
  Daemon daemon;
  Client odd(daemon);
  Client good(daemon);
  odd.open();
  good.open();
  daemon.engine.throw_once = true;
  odd.send(odd.request(1, 1.0));
  EXPECT_EQ(odd.next_as<Refusal>().reason, RefusalReason::limit);
  EXPECT_EQ(good.ask(good.request(1, 2.0)), seen_from(2.0));
}

TEST(Service, StopsWhenTheEngineIsLost) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  daemon.engine.lose_context = true;
  client.send(client.request(1, 1.0));
  EXPECT_THROW(daemon.run_until([] { return false; }), MachineError);
}

}  // namespace
}  // namespace sightline
