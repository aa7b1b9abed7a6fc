// Scenes over a real socket: a client with nothing but meshes ends with a session on them.
#include <gtest/gtest.h>

#include "tests/common/test_scenes.hpp"
#include "tests/control_view/scene_data_of.hpp"
#include "tests/control_view/test_client.hpp"

namespace sightline::test {
namespace {

SceneData two_boxes(double apart_m) {
  sightline::testing::SceneBuilder builder;
  const auto stone = builder.add_material(sightline::testing::opaque());
  builder.add_box({0, 0, -5}, {1, 1, 1}, stone);
  builder.add_box({apart_m, 0, -5}, {1, 1, 1}, stone);
  return scene_data_of(builder.finish());
}

/// A daemon that was started without a scene, and makes real engines.
struct EmptyDaemon {
  EmptyDaemon()
      : intake(scenes, {},
               [](const Scene& scene) {
                 EngineOptions options;
                 options.engine = "raster";
                 options.threads = 1;
                 return make_engine(scene, options);
               }),
        service(link, scenes, &intake, Daemon::default_options(), steady_clock()) {}

  /// Runs until a message has come, in bounded time.
  std::optional<Message> next_for(ClientLink& client) {
    const Clock clock = steady_clock();
    for (const double end_s = clock() + k_deadline_s; clock() < end_s;) {
      service.step(k_slice);
      if (const auto frame = client.receive(std::chrono::milliseconds{0})) {
        auto decoded = decode(*frame);
        if (auto* message = std::get_if<Message>(&decoded)) return std::move(*message);
        ADD_FAILURE() << std::get<DecodeError>(decoded).reason;
      }
    }
    ADD_FAILURE() << "the daemon did not answer";
    return {};
  }
  template <class Expected>
  Expected next_as(ClientLink& client) {
    const std::optional<Message> message = next_for(client);
    if (message) {
      if (const auto* expected = std::get_if<Expected>(&*message)) return *expected;
      ADD_FAILURE() << "another message came, number " << message->index();
    }
    return {};
  }
  SceneStatus upload(ClientLink& client, const Parcel& parcel) {
    client.send(encode(parcel.offer));
    SceneStatus status = next_as<SceneStatus>(client);
    for (std::uint32_t i = 0; i < parcel.chunk_count(); ++i) client.send(encode(parcel.chunk(i)));
    while (status.state == SceneState::uploading || status.state == SceneState::building)
      status = next_as<SceneStatus>(client);
    return status;
  }

  SceneStore scenes;
  ServerLink link{"tcp://127.0.0.1:*"};
  SceneIntake intake;
  Service service;
};

TEST(Uploads, OpenASessionOnASceneTheDaemonNeverHadAFileOf) {
  EmptyDaemon daemon;
  ClientLink client(daemon.link.bound_endpoint());
  const Parcel parcel(two_boxes(2.0));
  client.send(encode(Hello{k_protocol_version, "test", parcel.offer.scene_digest}));
  EXPECT_EQ(daemon.next_as<Refusal>(client).reason, RefusalReason::scene_mismatch);
  EXPECT_EQ(daemon.upload(client, parcel).state, SceneState::ready);
  client.send(encode(Hello{k_protocol_version, "test", parcel.offer.scene_digest}));
  const auto welcome = daemon.next_as<Welcome>(client);
  EXPECT_EQ(welcome.object_count, 2u);

  ViewRequest request;
  request.session_id = welcome.session_id;
  request.request_seq = 1;
  request.eyes = {{glm::dmat4(1.0), clip_from_camera(Perspective{}, 4.0 / 3.0)}};
  client.send(encode(request));
  const auto frame = daemon.next_as<VisibleSetFrame>(client);
  EXPECT_EQ(frame.visible_count, 2u);
  EXPECT_EQ(frame.scene_digest, parcel.offer.scene_digest);
}

TEST(Uploads, LetSessionsOnSeveralScenesSeeTheirOwn) {
  EmptyDaemon daemon;
  const Parcel near(two_boxes(2.0)), far(two_boxes(500.0));
  ClientLink a(daemon.link.bound_endpoint()), b(daemon.link.bound_endpoint());
  EXPECT_EQ(daemon.upload(a, near).state, SceneState::ready);
  EXPECT_EQ(daemon.upload(b, far).state, SceneState::ready);
  const auto visible_for = [&](ClientLink& client, const Parcel& parcel) {
    client.send(encode(Hello{k_protocol_version, "test", parcel.offer.scene_digest}));
    const auto welcome = daemon.next_as<Welcome>(client);
    ViewRequest request;
    request.session_id = welcome.session_id;
    request.request_seq = 1;
    request.eyes = {{glm::dmat4(1.0), clip_from_camera(Perspective{}, 4.0 / 3.0)}};
    client.send(encode(request));
    return daemon.next_as<VisibleSetFrame>(client).visible_count;
  };
  EXPECT_EQ(visible_for(a, near), 2u);
  EXPECT_EQ(visible_for(b, far), 1u);
  EXPECT_EQ(daemon.service.session_count(), 2u);
}

TEST(Uploads, DisturbNoSession) {
  EmptyDaemon daemon;
  const Parcel first(two_boxes(2.0)), second(two_boxes(3.0));
  ClientLink client(daemon.link.bound_endpoint());
  daemon.upload(client, first);
  client.send(encode(Hello{k_protocol_version, "test", first.offer.scene_digest}));
  const auto welcome = daemon.next_as<Welcome>(client);
  EXPECT_EQ(daemon.upload(client, second).state, SceneState::ready);
  ViewRequest request;
  request.session_id = welcome.session_id;
  request.request_seq = 1;
  request.eyes = {{glm::dmat4(1.0), clip_from_camera(Perspective{}, 4.0 / 3.0)}};
  client.send(encode(request));
  EXPECT_EQ(daemon.next_as<VisibleSetFrame>(client).scene_digest, first.offer.scene_digest);
}

TEST(Uploads, AreRefusedWithAReasonWhereNoneAreTaken) {
  Daemon daemon;
  Client client(daemon);
  const Parcel parcel(two_boxes(2.0));
  client.send(parcel.offer);
  const auto status = client.next_as<SceneStatus>();
  EXPECT_EQ(status.state, SceneState::failed);
  EXPECT_NE(status.text.find("--uploads on"), std::string::npos);
}

}  // namespace
}  // namespace sightline::test
