// libFuzzer target: a peer that says anything to a daemon that takes scenes, in any order. After each input
// an honest client beside it must still be answered.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <optional>
#include <random>
#include <string>

#include <spdlog/spdlog.h>
#include <unistd.h>

#include "control_view/service.hpp"
#include "protocol/scene_chunks.hpp"
#include "tests/control_view/fake_engine.hpp"
#include "tests/protocol/sample_messages.hpp"

namespace {

using namespace sightline;
using test::FakeEngine;
using test::k_object_count;

constexpr SceneDigest k_digest{1, 2, 3, 4};
constexpr std::chrono::milliseconds k_no_wait{0}, k_slice{1};
constexpr int k_most_frames = 64;

/// Bytes of an input, zeros when they are used up.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  [[nodiscard]] bool empty() const { return at_ >= size_; }
  std::uint8_t byte() { return empty() ? 0 : data_[at_++]; }
  Bytes bytes(std::size_t most) {
    Bytes result;
    while (result.size() < most && !empty()) result.push_back(std::byte{byte()});
    return result;
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_, at_ = 0;
};

struct World {
  World()
      : scenes(served_scene({k_digest, k_object_count}, std::make_unique<FakeEngine>())),
        link("ipc:///tmp/sightline-fuzz-" + std::to_string(getpid())),
        intake(scenes, limits(), [](const Scene&) { return std::make_unique<FakeEngine>(); }),
        service(link, scenes, &intake, options(), [this] { return now_s; }),
        hostile(link.bound_endpoint()),
        honest(link.bound_endpoint()) {
    spdlog::set_level(spdlog::level::off);
  }

  static IntakeLimits limits() {
    IntakeLimits limits;
    limits.scene_bytes = 1u << 20;
    limits.all_bytes = 4u << 20;
    limits.objects = 1000;
    return limits;
  }
  static ServiceOptions options() {
    ServiceOptions options;
    options.pipeline = {{64, 48}, 2, 0.0, false};
    options.max_sessions = 2;
    return options;
  }

  /// What the daemon says to a client, while it runs; aborts where it falls silent.
  template <class Expected>
  Expected must_say(ClientLink& client) {
    for (int step = 0; step < 5000; ++step) {
      service.step(k_slice);
      while (const auto frame = client.receive(k_no_wait)) {
        const auto decoded = decode(*frame);
        const auto* message = std::get_if<Message>(&decoded);
        if (message == nullptr) std::abort();  // the daemon's own frames are well formed
        if (const auto* expected = std::get_if<Expected>(message)) return *expected;
      }
    }
    std::abort();
  }

  void drain_hostile() {
    while (const auto frame = hostile.receive(k_no_wait)) {
      const auto decoded = decode(*frame);
      const auto* message = std::get_if<Message>(&decoded);
      if (message == nullptr) std::abort();
      if (const auto* welcome = std::get_if<Welcome>(message)) session_id = welcome->session_id;
    }
  }

  double now_s = 1000.0;
  SceneStore scenes;
  ServerLink link;
  SceneIntake intake;
  Service service;
  ClientLink hostile, honest;
  std::uint64_t session_id = 0;
};

/// A message of any kind, by the input's own bytes; some of its fields are made to fit the daemon.
Bytes next_frame(Input& input, World& world) {
  const std::uint8_t kind = input.byte();
  if (kind >= 240) return input.bytes(input.byte());
  std::mt19937_64 random(input.byte() * 256u + input.byte());
  Message message = random_message(kind % std::variant_size_v<Message>, random);
  if (auto* hello = std::get_if<Hello>(&message)) {
    hello->version = k_protocol_version;
    if (kind % 3 != 0) hello->scene_digest = k_digest;
  } else if (auto* request = std::get_if<ViewRequest>(&message)) {
    request->session_id = world.session_id;
  } else if (auto* why = std::get_if<Why>(&message)) {
    why->session_id = world.session_id;
  } else if (auto* offer = std::get_if<SceneOffer>(&message)) {
    offer->byte_count = 1 + input.byte();
    offer->chunk_digests.resize(1);
    offer->object_count = input.byte();
    offer->triangle_count = input.byte();
    offer->scene_digest = scene_digest_of(*offer);
  }
  Bytes frame = encode(message);
  for (int changes = kind % 4; changes > 0; --changes)
    frame[(input.byte() * 256u + input.byte()) % frame.size()] = std::byte{input.byte()};
  return frame;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static World world;
  Input input(data, size);
  for (int i = 0; i < k_most_frames && !input.empty(); ++i) {
    world.hostile.send(next_frame(input, world));
    world.service.step(k_no_wait);
    world.drain_hostile();
    world.now_s += input.byte() / 16.0;
  }
  // Whatever was said, and however long ago the honest client's last session was reaped.
  world.hostile.reconnect();
  for (const double passed_s : {20.0, 1.0}) {  // found silent, and then closed
    world.now_s += passed_s;
    world.service.step(k_no_wait);
  }
  world.honest.send(encode(Hello{k_protocol_version, "honest", k_digest}));
  const auto welcome = world.must_say<Welcome>(world.honest);
  ViewRequest request;
  request.session_id = welcome.session_id;
  request.request_seq = 1;
  request.eyes = {test::eye_at(1.0)};
  world.honest.send(encode(request));
  if (world.must_say<VisibleSetFrame>(world.honest).session_id != welcome.session_id) std::abort();
  world.honest.send(encode(Goodbye{welcome.session_id}));
  return 0;
}
