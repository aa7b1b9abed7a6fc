// What a daemon must survive, and what must not harm its other sessions.

#include <chrono>
#include <random>

#include <gtest/gtest.h>

#include "common/scene/load_scene.hpp"
#include "main_view/client/culling_core.hpp"
#include "main_view/client/culling_session.hpp"
#include "tests/integration/scenario.hpp"

namespace sightline {
namespace {

using namespace testing;
using std::chrono::milliseconds;

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// The next message of a kind, others skipped.
template <class Wanted>
std::optional<Wanted> receive(ClientLink& link, milliseconds timeout = milliseconds(5000)) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (std::chrono::steady_clock::now() < deadline) {
    const auto frame = link.receive(milliseconds(50));
    if (!frame) continue;
    auto decoded = decode(*frame);
    if (auto* message = std::get_if<Message>(&decoded)) {
      if (auto* wanted = std::get_if<Wanted>(message)) return *wanted;
    }
  }
  return std::nullopt;
}

/// Sends a frame, and waits for room in the queue so that it does leave. False when there is none in time.
bool send_surely(ClientLink& link, const Bytes& frame, milliseconds timeout = milliseconds(10'000)) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (!link.send(frame)) {
    if (std::chrono::steady_clock::now() >= deadline) return false;
    (void)link.receive(milliseconds(1));
  }
  return true;
}

class HostilePeer : public ::testing::Test {
 protected:
  SessionOptions honest_options() {
    SessionOptions options;
    options.endpoint = daemon_.endpoint();
    options.scene_digest = scene_.digest;
    options.object_count = scene_.object_count();
    return options;
  }

  /// The answer to one honest request, or empty.
  static std::optional<Answer> ask(CullingSession& session, CullingCore& core) {
    core.add_pose({now_s(), Pose{{0.0, 1.7, 0.0}, {1.0, 0.0, 0.0, 0.0}}});
    const ViewRequest request = core.make_request(now_s(), {160, 120});
    session.send(request, now_s());
    return session.wait_for(request.request_seq, 20.0);
  }

  Scenario city_ = small_city();
  Scene scene_ = load_scene(city_.scene_file(), {.shading = false});
  Daemon daemon_{{"--scene", city_.scene_file(), "--size", "160x120"}};
};

TEST_F(HostilePeer, OfAnotherVersionIsToldSo) {
  ClientLink link(daemon_.endpoint());
  link.send(encode(
      Hello{.version = k_protocol_version + 1, .client_name = "tomorrow", .scene_digest = scene_.digest}));
  const auto refusal = receive<Refusal>(link);
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->reason, RefusalReason::version_mismatch);
  EXPECT_EQ(refusal->server_version, k_protocol_version);
  EXPECT_FALSE(refusal->text.empty());
}

TEST_F(HostilePeer, WithAnotherSceneIsToldSo) {
  SessionOptions options = honest_options();
  options.scene_digest[0] ^= 0xff;
  CullingSession session(options);
  EXPECT_EQ(session.wait_until_open(10.0), SessionState::refused);
  ASSERT_TRUE(session.refusal());
  EXPECT_EQ(session.refusal()->reason, RefusalReason::scene_mismatch);
  EXPECT_EQ(session.refusal()->server_scene_digest, scene_.digest);
}

TEST_F(HostilePeer, DoesNotDisturbAnHonestSession) {
  CullingSession honest(honest_options());
  CullingCore core({}, {{glm::dmat4(1.0), clip_from_camera(Perspective{}, 4.0 / 3.0)}});
  ASSERT_EQ(honest.wait_until_open(20.0), SessionState::open);
  const auto before = ask(honest, core);
  ASSERT_TRUE(before);

  ClientLink hostile(daemon_.endpoint());
  std::mt19937 random(99);
  const Bytes valid = encode(Hello{.client_name = "hostile", .scene_digest = scene_.digest});
  for (std::size_t length = 0; length < valid.size(); ++length) {
    const Bytes prefix(valid.begin(), valid.begin() + static_cast<std::ptrdiff_t>(length));
    ASSERT_TRUE(send_surely(hostile, prefix));
  }
  for (int i = 0; i < 500; ++i) {
    Bytes noise(random() % 2000);
    for (std::byte& b : noise) b = std::byte(random());
    ASSERT_TRUE(send_surely(hostile, noise));
    Bytes flipped = valid;
    flipped[random() % flipped.size()] ^= std::byte(1u << (random() % 8));
    ASSERT_TRUE(send_surely(hostile, flipped));
  }
  ASSERT_TRUE(send_surely(hostile, Bytes(80u << 20)));  // above the limit: ZeroMQ cuts the connection

  for (int i = 0; i < 5; ++i) {
    const auto after = ask(honest, core);
    ASSERT_TRUE(after) << "the daemon no longer answers";
    EXPECT_EQ(after->set, before->set);  // the camera stands still
  }
  EXPECT_EQ(honest.lost_count(), 0u);
}

TEST_F(HostilePeer, MayFloodTheDaemonAndGo) {
  for (int round = 0; round < 3; ++round) {
    LinkOptions roomy;
    roomy.send_queue_length = 5000;
    ClientLink hostile(daemon_.endpoint(), roomy);
    ASSERT_TRUE(send_surely(hostile, encode(Hello{.client_name = "hostile", .scene_digest = scene_.digest})));
    const auto welcome = receive<Welcome>(hostile);
    ASSERT_TRUE(welcome);
    ViewRequest request;
    request.session_id = welcome->session_id;
    request.request_seq = 1;
    request.main_size = {16384, 16384};
    request.eyes.assign(8, Eye{glm::dmat4(1.0), clip_from_camera(Perspective{}, 4.0 / 3.0)});
    ASSERT_TRUE(send_surely(hostile, encode(request)));
    for (int i = 0; i < 3000; ++i) ASSERT_TRUE(send_surely(hostile, encode(Ping{1, 1.0})));
  }
  CullingSession honest(honest_options());
  CullingCore core({}, {{glm::dmat4(1.0), clip_from_camera(Perspective{}, 4.0 / 3.0)}});
  ASSERT_EQ(honest.wait_until_open(20.0), SessionState::open);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(ask(honest, core)) << "the daemon no longer answers";
}

TEST_F(HostilePeer, CannotUseASessionThatIsNotItsOwn) {
  CullingSession honest(honest_options());
  ASSERT_EQ(honest.wait_until_open(20.0), SessionState::open);
  ClientLink thief(daemon_.endpoint());
  ViewRequest request;
  request.session_id = honest.welcome()->session_id;
  request.request_seq = 1;
  request.eyes = {Eye{glm::dmat4(1.0), clip_from_camera(Perspective{}, 4.0 / 3.0)}};
  thief.send(encode(request));
  const auto refusal = receive<Refusal>(thief);
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->reason, RefusalReason::no_session);
}

}  // namespace
}  // namespace sightline
