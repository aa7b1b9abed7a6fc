// Several views of one session: each has its own requests, sets and filter.
#include <gtest/gtest.h>

#include "tests/control_view/test_client.hpp"

namespace sightline::test {
namespace {

ViewRequest through(std::uint8_t view, ViewRequest request) {
  request.view = view;
  return request;
}

TEST(SessionViews, EachHaveTheirOwnRequestsAndSets) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  for (const std::uint8_t view : {0, 3, 15}) {
    client.send(through(view, client.request(1, 10.0 + view)));
    const auto frame = client.next_as<VisibleSetFrame>();
    EXPECT_EQ(frame.view, view);
    EXPECT_EQ(frame.set_seq, 1u);
    EXPECT_EQ(frame.request_seq, 1u);
    EXPECT_EQ(frame.base_seq, 0u);
    EXPECT_EQ(client.set_of(frame), seen_from(10.0 + view));
  }
}

TEST(SessionViews, DoNotReplaceEachOthersRequests) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  client.send(through(0, client.request(1, 1.0)));
  client.send(through(1, client.request(1, 2.0)));
  client.send(through(0, client.request(2, 3.0)));  // replaces the first, and waits since then
  std::map<int, std::uint64_t> answered;
  while (answered != std::map<int, std::uint64_t>{{0, 2}, {1, 1}}) {
    const auto frame = client.next_as<VisibleSetFrame>();
    ASSERT_NE(frame.request_seq, 0u) << "one of the views was not answered";
    answered[frame.view] = frame.request_seq;
  }
}

TEST(SessionViews, ShareMovesAndPresence) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  ViewRequest request = client.request(1, 1.0);
  request.moves = {{ObjectId{4321}, glm::dmat4x3(1.0)}};
  client.send(request);
  (void)client.next_as<VisibleSetFrame>();
  client.send(through(1, client.request(1, 2.0)));
  const VisibleSet set = client.set_of(client.next_as<VisibleSetFrame>());
  EXPECT_TRUE(set.contains(ObjectId{4321}));  // the fake engine sees all that moved
}

// Its client takes the answer for one to what it had said by then, in that view.
TEST(SessionViews, AreAnsweredWithTheEditsTheyWereAskedWith) {
  const auto scene = served_scene({k_digest, k_object_count}, std::make_unique<FakeEngine>());
  auto& engine = static_cast<FakeEngine&>(*scene->engine);
  Session session(
      8, "peer", "client", scene, {{100, 80}, 1, 0.0, false}, [] { return 0.0; }, 0.0);
  ViewRequest request;
  request.request_seq = 1;
  request.eyes = {eye_at(1.0)};
  session.accept(through(1, request), 0.0);
  request.presence = {{ObjectId{7}, false}};
  session.accept(request, 1.0);
  EXPECT_EQ(session.answer(2.0).view, 1u);
  EXPECT_TRUE(engine.edits().hidden.empty());
  EXPECT_EQ(engine.edits().view, 1u);
  EXPECT_EQ(session.answer(2.0).view, 0u);
  EXPECT_EQ(engine.edits().hidden, std::vector<ObjectId>{ObjectId{7}});
  request.request_seq = 2;
  request.presence.clear();
  session.accept(through(1, request), 3.0);
  (void)session.answer(3.0);
  EXPECT_EQ(engine.edits().hidden, std::vector<ObjectId>{ObjectId{7}});
}

TEST(SessionViews, HaveTheControlSizeTheyAskFor) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  ViewRequest request = client.request(1, 1.0);
  request.control_size = {320, 200};
  client.send(request);
  (void)client.next_as<VisibleSetFrame>();
  EXPECT_EQ(daemon.engine.sizes.back(), (ImageSize{320, 200}));
  client.send(client.request(2, 1.0));
  (void)client.next_as<VisibleSetFrame>();
  EXPECT_EQ(daemon.engine.sizes.back(), (ImageSize{100, 80}));
}

TEST(SessionViews, OfSixteenAtMostAndNoOthers) {
  Daemon daemon;
  Client client(daemon);
  client.open();
  client.send(through(16, client.request(1, 1.0)));
  EXPECT_EQ(client.next_as<Refusal>().reason, RefusalReason::malformed);
  ViewRequest request = client.request(1, 1.0);
  request.control_size = {16384, 16384};
  client.send(request);
  client.settle();
  EXPECT_EQ(daemon.service.counters().malformed, 2u);
  EXPECT_EQ(daemon.service.counters().answered, 0u);
}

TEST(SessionViews, OfALightLeaveOutWhatCastsNoShadow) {
  Daemon daemon;
  std::vector<SceneData::Object> objects(k_object_count);
  objects[77].flags = static_cast<std::uint32_t>(ObjectFlag::casts_no_shadow);
  daemon.scenes.own()->roles = SceneRoles(objects);
  Client client(daemon);
  client.open();
  ViewRequest request = client.request(1, 1.0);
  request.presence = {{ObjectId{5}, false}};
  client.send(request);
  (void)client.next_as<VisibleSetFrame>();
  EXPECT_EQ(daemon.engine.edits().hidden, std::vector<ObjectId>{ObjectId{5}});
  const SceneEdits plain = daemon.engine.edits();
  request = through(1, client.request(1, 1.0));
  request.view_kind = ViewKind::shadow_map;
  client.send(request);
  (void)client.next_as<VisibleSetFrame>();
  EXPECT_EQ(daemon.engine.edits().hidden, (std::vector<ObjectId>{ObjectId{5}, ObjectId{77}}));
  EXPECT_NE(daemon.engine.edits().owner, plain.owner);
  client.send(client.request(2, 1.0));
  (void)client.next_as<VisibleSetFrame>();
  EXPECT_EQ(daemon.engine.edits().hidden, plain.hidden);
  EXPECT_EQ(daemon.engine.edits().owner, plain.owner);
}

}  // namespace
}  // namespace sightline::test
