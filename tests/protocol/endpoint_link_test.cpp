#include "protocol/endpoint_link.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#include <zmq.hpp>

#include "common/error.hpp"
#include "temporary_directory.hpp"

namespace sightline {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using testing::HasSubstr;

constexpr auto k_patience = 10s;
constexpr const char* k_loopback = "tcp://127.0.0.1:*";

Bytes bytes_of(std::string_view text) {
  const auto* begin = reinterpret_cast<const std::byte*>(text.data());
  return Bytes(begin, begin + text.size());
}

std::string text_of(std::span<const std::byte> bytes) {
  return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

/// Calls `attempt` until it holds; it must wait a little by itself, for instance within a receive.
bool eventually(const std::function<bool()>& attempt) {
  const auto deadline = Clock::now() + k_patience;
  while (Clock::now() < deadline) {
    if (attempt()) return true;
  }
  return false;
}

/// Sends `text` again and again until the server has received exactly it, and gives the peer that sent it.
PeerId deliver(ClientLink& client, ServerLink& server, const std::string& text) {
  PeerId peer;
  EXPECT_TRUE(eventually([&] {
    (void)client.send(bytes_of(text));
    const auto incoming = server.receive(20ms);
    if (!incoming || text_of(incoming->frame) != text) return false;
    peer = incoming->peer;
    return true;
  })) << text;
  return peer;
}

void expect_echo(ClientLink& client, ServerLink& server) {
  ASSERT_TRUE(client.send(bytes_of("question")));
  const auto incoming = server.receive(k_patience);
  ASSERT_TRUE(incoming);
  EXPECT_EQ(text_of(incoming->frame), "question");
  ASSERT_TRUE(server.send(incoming->peer, bytes_of("answer")));
  const auto answer = client.receive(k_patience);
  ASSERT_TRUE(answer);
  EXPECT_EQ(text_of(*answer), "answer");
}

std::string machine_error_of(const std::string& endpoint) {
  try {
    const ServerLink link(endpoint);
  } catch (const MachineError& error) {
    return error.what();
  }
  return "bound";
}

TEST(Link, CarriesFramesOverTcp) {
  ServerLink server(k_loopback);
  ClientLink client(server.bound_endpoint());
  expect_echo(client, server);
  EXPECT_EQ(client.bytes_sent(), 8u);
  EXPECT_EQ(client.bytes_received(), 6u);
}

TEST(Link, CarriesFramesOverIpv6) {
  std::optional<ServerLink> server;
  try {
    server.emplace("tcp://[::1]:*");
  } catch (const MachineError&) {
    GTEST_SKIP() << "this machine has no IPv6 loopback";
  }
  ClientLink client(server->bound_endpoint());
  expect_echo(client, *server);
}

TEST(Link, CarriesFramesOverIpc) {
  const TemporaryDirectory directory;
  ServerLink server("ipc://" + directory.file("socket"));
  ClientLink client(server.bound_endpoint());
  expect_echo(client, server);
}

TEST(Link, BindsToEveryInterface) {
  ServerLink server("tcp://*:*");
  const std::string bound = server.bound_endpoint();
  ClientLink client("tcp://127.0.0.1" + bound.substr(bound.rfind(':')));
  expect_echo(client, server);
}

TEST(Link, ConnectsBeforeTheServerIsThere) {
  const TemporaryDirectory directory;
  const std::string endpoint = "ipc://" + directory.file("socket");
  ClientLink client(endpoint);
  ASSERT_TRUE(client.send(bytes_of("early")));
  ServerLink server(endpoint);
  const auto incoming = server.receive(k_patience);
  ASSERT_TRUE(incoming);
  EXPECT_EQ(text_of(incoming->frame), "early");
}

TEST(Link, TellsPeersApart) {
  ServerLink server(k_loopback);
  ClientLink first(server.bound_endpoint());
  ClientLink second(server.bound_endpoint());
  const PeerId first_peer = deliver(first, server, "first");
  const PeerId second_peer = deliver(second, server, "second");
  EXPECT_NE(first_peer, second_peer);
  ASSERT_TRUE(server.send(second_peer, bytes_of("for second")));
  ASSERT_TRUE(server.send(first_peer, bytes_of("for first")));
  EXPECT_EQ(text_of(first.receive(k_patience).value()), "for first");
  EXPECT_EQ(text_of(second.receive(k_patience).value()), "for second");
}

TEST(Link, ReturnsEmptyWithinItsTimeout) {
  ServerLink server(k_loopback);
  ClientLink client(server.bound_endpoint());
  const auto begin = Clock::now();
  EXPECT_FALSE(server.receive(0ms));
  EXPECT_FALSE(client.receive(0ms));
  EXPECT_FALSE(server.receive(20ms));
  EXPECT_FALSE(client.receive(20ms));
  EXPECT_GE(Clock::now() - begin, 30ms);  // it did wait; a millisecond's rounding is ZeroMQ's
  EXPECT_LT(Clock::now() - begin, k_patience);
}

TEST(Link, CarriesEmptyFramesAndLargeOnes) {
  ServerLink server(k_loopback);
  ClientLink client(server.bound_endpoint());
  ASSERT_TRUE(client.send(Bytes{}));
  EXPECT_TRUE(server.receive(k_patience).value().frame.empty());
  const Bytes large(8u << 20, std::byte{0x5A});
  ASSERT_TRUE(client.send(large));
  EXPECT_TRUE(std::ranges::equal(server.receive(k_patience).value().frame, large));
}

TEST(Link, SendsAFrameFromWhereItLiesAndThenLetsGoOfIt) {
  ServerLink server(k_loopback);
  ClientLink client(server.bound_endpoint());
  auto bytes = std::make_shared<const Bytes>(1u << 20, std::byte{0x5A});
  const std::weak_ptr<const Bytes> held = bytes;
  ASSERT_TRUE(client.send(Frame(bytes, *bytes)));
  EXPECT_EQ(client.bytes_sent(), 1u << 20);
  bytes.reset();
  const auto incoming = server.receive(k_patience);
  ASSERT_TRUE(incoming);
  EXPECT_EQ(incoming->frame.size(), 1u << 20);
  EXPECT_EQ(std::ranges::count(incoming->frame, std::byte{0x5A}), 1 << 20);
  EXPECT_TRUE(eventually([&] {
    (void)client.receive(1ms);
    return held.expired();
  }));
}

TEST(Link, LeavesAFrameThatItDoesNotTakeToTheCaller) {
  LinkOptions options;
  options.send_queue_length = 2;
  const auto bytes = std::make_shared<const Bytes>(bytes_of("frame"));
  const Frame frame(bytes, *bytes);
  std::optional<ClientLink> client(std::in_place, "tcp://127.0.0.1:9", options);  // nobody listens
  while (client->send(frame)) {
  }
  EXPECT_EQ(text_of(frame), "frame");
  client.reset();
  EXPECT_TRUE(eventually([&] { return bytes.use_count() == 2; }));
}

TEST(Link, KeepsAReceivedFrameWhileOthersCome) {
  ServerLink server(k_loopback);
  ClientLink client(server.bound_endpoint());
  std::vector<Frame> kept;
  for (const char* text : {"first", "second", "third"}) {
    ASSERT_TRUE(client.send(bytes_of(text)));
    kept.push_back(server.receive(k_patience).value().frame);
  }
  EXPECT_EQ(text_of(kept[0]), "first");
  EXPECT_EQ(text_of(kept[1]), "second");
  EXPECT_EQ(text_of(kept[2]), "third");
}

TEST(Link, DropsFramesOverTheLimitAndGoesOn) {
  LinkOptions options;
  options.max_frame_bytes = 1000;
  ServerLink server(k_loopback, options);
  ClientLink client(server.bound_endpoint());
  ASSERT_TRUE(client.send(Bytes(1000)));
  EXPECT_EQ(server.receive(k_patience).value().frame.size(), 1000u);
  ASSERT_TRUE(client.send(Bytes(1001)));
  std::size_t largest = 0;
  EXPECT_TRUE(eventually([&] {
    (void)client.send(bytes_of("small"));
    const auto incoming = server.receive(20ms);
    if (incoming) largest = std::max(largest, incoming->frame.size());
    return incoming.has_value();
  }));
  EXPECT_EQ(largest, 5u);
}

TEST(Link, RefusesToSendToAnUnknownPeer) {
  ServerLink server(k_loopback);
  EXPECT_FALSE(server.send("nobody", bytes_of("lost")));
  EXPECT_FALSE(server.send("", bytes_of("lost")));
}

TEST(Link, ForgetsAPeerThatLeft) {
  ServerLink server(k_loopback);
  PeerId peer;
  {
    ClientLink client(server.bound_endpoint());
    peer = deliver(client, server, "here");
    EXPECT_TRUE(server.send(peer, bytes_of("found")));
  }
  EXPECT_TRUE(eventually([&] {
    (void)server.receive(5ms);
    return !server.send(peer, bytes_of("lost"));
  }));
}

TEST(Link, RefusesFramesOfAClientWhoseQueueIsFull) {
  LinkOptions options;
  options.send_queue_length = 4;
  ClientLink client("tcp://127.0.0.1:9", options);  // the discard port: nobody listens
  const auto begin = Clock::now();
  int accepted = 0;
  while (accepted < 1000 && client.send(bytes_of("frame"))) ++accepted;
  EXPECT_EQ(accepted, 4);
  EXPECT_LT(Clock::now() - begin, 1s);
}

TEST(Link, RefusesFramesForAPeerThatDoesNotRead) {
  LinkOptions options;
  options.send_queue_length = 4;
  options.receive_queue_length = 4;
  ServerLink server(k_loopback, options);
  ClientLink idle(server.bound_endpoint(), options);
  ClientLink other(server.bound_endpoint(), options);
  const PeerId idle_peer = deliver(idle, server, "idle");
  const PeerId other_peer = deliver(other, server, "other");

  const Bytes frame(1u << 20);
  int accepted = 0;
  while (accepted < 2000 && server.send(idle_peer, frame)) ++accepted;
  EXPECT_LT(accepted, 2000);
  // Its neighbour is served all the same.
  ASSERT_TRUE(server.send(other_peer, bytes_of("answer")));
  EXPECT_EQ(text_of(other.receive(k_patience).value()), "answer");
}

TEST(Link, ReconnectsToAServerThatCameBack) {
  std::optional<ServerLink> server(k_loopback);
  const std::string endpoint = server->bound_endpoint();
  ClientLink client(endpoint);
  deliver(client, *server, "before");
  server.reset();
  server.emplace(endpoint);
  const PeerId peer = deliver(client, *server, "after");
  ASSERT_TRUE(server->send(peer, bytes_of("answer")));
  EXPECT_EQ(text_of(client.receive(k_patience).value()), "answer");
}

TEST(Link, StartsAfreshOnReconnect) {
  ServerLink server(k_loopback);
  ClientLink client(server.bound_endpoint());
  const PeerId before = deliver(client, server, "before");
  ASSERT_TRUE(server.send(before, bytes_of("for the old connection")));
  client.reconnect();
  const PeerId after = deliver(client, server, "after");
  EXPECT_NE(before, after);
  ASSERT_TRUE(server.send(after, bytes_of("for the new one")));
  EXPECT_EQ(text_of(client.receive(k_patience).value()), "for the new one");
}

TEST(Link, DeliversTheLastFrameBeforeItCloses) {
  std::optional<ServerLink> server(k_loopback);
  ClientLink client(server->bound_endpoint());
  {
    ClientLink leaving(server->bound_endpoint());
    deliver(leaving, *server, "here");
    ASSERT_TRUE(leaving.send(bytes_of("goodbye")));
  }
  EXPECT_TRUE(eventually([&] {
    const auto incoming = server->receive(20ms);
    return incoming && text_of(incoming->frame) == "goodbye";
  }));
  const PeerId peer = deliver(client, *server, "here");
  ASSERT_TRUE(server->send(peer, bytes_of("shutting down")));
  server.reset();
  const auto last = client.receive(k_patience);
  ASSERT_TRUE(last);
  EXPECT_EQ(text_of(*last), "shutting down");
}

TEST(Link, DropsMessagesOfTheWrongNumberOfParts) {
  ServerLink server(k_loopback);
  zmq::context_t context;
  zmq::socket_t raw(context, zmq::socket_type::dealer);
  raw.set(zmq::sockopt::linger, 0);
  raw.connect(server.bound_endpoint());
  for (int i = 0; i < 100; ++i) {
    raw.send(zmq::str_buffer("one"), zmq::send_flags::sndmore);
    raw.send(zmq::str_buffer("two"), zmq::send_flags::none);
  }
  raw.send(zmq::str_buffer("whole"), zmq::send_flags::none);
  std::optional<ServerLink::Incoming> incoming;
  EXPECT_TRUE(eventually([&] { return (incoming = server.receive(20ms)).has_value(); }));
  EXPECT_EQ(text_of(incoming->frame), "whole");
}

TEST(Link, SurvivesAPeerThatSpeaksNoZeroMq) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("socket");
  ServerLink server("ipc://" + path);
  const int raw = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.data(), path.size());
  ASSERT_EQ(::connect(raw, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  const std::string request = "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n" + std::string(4096, '\xFF');
  EXPECT_GT(::send(raw, request.data(), request.size(), MSG_NOSIGNAL), 0);
  ClientLink client("ipc://" + path);
  expect_echo(client, server);
  ::close(raw);
}

// libzmq 4.3.4 with heartbeats on aborted the process here: it wrote one to a connection that was known to be
// broken, but not yet closed because its frames waited for room in the receive queue.
TEST(Link, SurvivesAPeerThatFloodsItAndGoes) {
  ServerLink server(k_loopback);
  PeerId peer;
  {
    LinkOptions roomy;
    roomy.send_queue_length = 5000;
    ClientLink hostile(server.bound_endpoint(), roomy);
    peer = deliver(hostile, server, "here");
    for (int i = 0; i < 5000; ++i) (void)hostile.send(Bytes(80));
  }
  // What is written to it now tells the server's side that the connection is broken.
  for (int i = 0; i < 3; ++i) (void)server.send(peer, bytes_of("anybody there?"));
  ClientLink honest(server.bound_endpoint());
  EXPECT_FALSE(honest.receive(2500ms));  // nothing is read meanwhile: two heartbeats would have come due
  ASSERT_TRUE(honest.send(bytes_of("question")));
  EXPECT_TRUE(eventually([&] {
    const auto incoming = server.receive(20ms);
    return incoming && text_of(incoming->frame) == "question";
  }));
}

TEST(Link, NamesAnEndpointInUse) {
  const ServerLink server(k_loopback);
  EXPECT_THAT(machine_error_of(server.bound_endpoint()), HasSubstr(server.bound_endpoint() + "' is in use"));
}

TEST(Link, NamesAnEndpointThatCannotBeBound) {
  EXPECT_THAT(machine_error_of("tcp://192.0.2.1:5555"), HasSubstr("tcp://192.0.2.1:5555"));
  const TemporaryDirectory directory;
  EXPECT_THAT(machine_error_of("ipc://" + directory.file("none/socket")), HasSubstr("none/socket"));
}

TEST(Link, DoesNotStealAnIpcPathInUse) {
  const TemporaryDirectory directory;
  const std::string endpoint = "ipc://" + directory.file("socket");
  ServerLink server(endpoint);
  EXPECT_THAT(machine_error_of(endpoint), HasSubstr("is in use"));
  ClientLink client(endpoint);
  expect_echo(client, server);
}

TEST(Link, TakesOverAnIpcPathLeftByADeadProcess) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("socket");
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.data(), path.size());
  const int dead = ::socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(::bind(dead, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  ASSERT_EQ(::listen(dead, 1), 0);
  ::close(dead);
  ASSERT_TRUE(std::filesystem::exists(path));

  ServerLink server("ipc://" + path);
  ClientLink client("ipc://" + path);
  expect_echo(client, server);
}

TEST(Link, DoesNotDeleteAFileThatIsNoSocket) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("notes.txt");
  std::ofstream(path) << "precious";
  EXPECT_THAT(machine_error_of("ipc://" + path), HasSubstr("no socket"));
  EXPECT_EQ(std::filesystem::file_size(path), 8u);
}

struct KeyPairs {
  LinkOptions server;
  LinkOptions client;
};

KeyPairs matching_keys() {
  KeyPairs pairs;
  pairs.server.curve = make_curve_keys();
  pairs.client.curve = make_curve_keys();
  pairs.client.curve.server_public_key = pairs.server.curve.public_key;
  return pairs;
}

TEST(EncryptedLink, CarriesFramesWithTheRightKeys) {
  const KeyPairs pairs = matching_keys();
  ServerLink server(k_loopback, pairs.server);
  ClientLink client(server.bound_endpoint(), pairs.client);
  expect_echo(client, server);
}

TEST(EncryptedLink, LetsNobodyInWithAWrongKeyOrNone) {
  const KeyPairs pairs = matching_keys();
  LinkOptions wrong = pairs.client;
  wrong.curve.server_public_key = make_curve_keys().public_key;
  ServerLink server(k_loopback, pairs.server);
  ClientLink stranger(server.bound_endpoint(), wrong);
  ClientLink plain(server.bound_endpoint());
  ASSERT_TRUE(stranger.send(bytes_of("stranger")));
  ASSERT_TRUE(plain.send(bytes_of("plain")));

  // Twenty connections of a client with the right key, one after another, give the others all the time they
  // need.
  for (int i = 0; i < 20; ++i) {
    ClientLink client(server.bound_endpoint(), pairs.client);
    ASSERT_TRUE(client.send(bytes_of("friend")));
    const auto incoming = server.receive(k_patience);
    ASSERT_TRUE(incoming);
    EXPECT_EQ(text_of(incoming->frame), "friend");
  }
  EXPECT_FALSE(server.receive(100ms));
}

TEST(EncryptedLink, DoesNotTalkToAServerWithoutEncryption) {
  const KeyPairs pairs = matching_keys();
  ServerLink server(k_loopback);
  ClientLink client(server.bound_endpoint(), pairs.client);
  ASSERT_TRUE(client.send(bytes_of("secret")));
  EXPECT_FALSE(server.receive(200ms));
}

TEST(EncryptedLink, RefusesKeysThatAreNone) {
  KeyPairs pairs = matching_keys();
  pairs.client.curve.server_public_key.clear();
  EXPECT_THROW(ClientLink("tcp://127.0.0.1:9", pairs.client), InputError);
  pairs = matching_keys();
  pairs.client.curve.server_public_key = "no key";
  EXPECT_THROW(ClientLink("tcp://127.0.0.1:9", pairs.client), InputError);
  pairs.server.curve.secret_key = std::string(40, '~');
  EXPECT_THROW(ServerLink(k_loopback, pairs.server), InputError);
}

}  // namespace
}  // namespace sightline
