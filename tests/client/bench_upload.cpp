// What it takes to give a daemon a scene: bench_upload FILE
#include <algorithm>
#include <cstdio>
#include <thread>

#include "common/scene/load_scene.hpp"
#include "main_view/client/culling_client.hpp"
#include "protocol/scene_chunks.hpp"
#include "tests/client/client_scenes.hpp"
#include "tests/client/describe_scene.hpp"
#include "tests/client/service_thread.hpp"

namespace sightline {
namespace {

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// The same bytes in pieces of a chunk from a thread to another over loopback, nothing else done.
double plain_copy_s(const std::vector<std::uint8_t>& bytes) {
  ServerLink server("tcp://127.0.0.1:*");
  const std::string endpoint = server.bound_endpoint();
  const std::size_t count = chunk_count_of(bytes.size());
  const double began_s = now_s();
  std::thread sender([&] {
    ClientLink client(endpoint);
    for (std::uint32_t i = 0; i < count;) {
      const auto chunk = std::as_bytes(chunk_of(bytes, i));
      if (client.send(Bytes(chunk.begin(), chunk.end()))) {
        ++i;
      } else {
        (void)client.receive(std::chrono::milliseconds(1));
      }
    }
    (void)client.receive(std::chrono::milliseconds(2000));
  });
  for (std::size_t got = 0; got < count;) {
    if (const auto incoming = server.receive(std::chrono::milliseconds(1000))) {
      ++got;
      if (got == count) server.send(incoming->peer, Bytes(1));
    }
  }
  const double passed_s = now_s() - began_s;
  sender.join();
  return passed_s;
}

CullingClient client_of(const std::string& endpoint, std::shared_ptr<const PackedScene> scene) {
  ClientOptions options;
  options.endpoint = endpoint;
  options.silence_limit_s = 20.0;
  return {options, std::move(scene)};
}

/// Seconds until the daemon has all bytes, and until it is ready.
std::pair<double, double> upload_s(CullingClient& client) {
  const double began_s = now_s();
  double sent_s = 0.0;
  while (client.wait_until_ready(0.001) != ClientState::ready && now_s() - began_s < 120.0) {
    if (sent_s == 0.0 && client.state() == ClientState::building) sent_s = now_s() - began_s;
  }
  return {sent_s, now_s() - began_s};
}

int run(const char* file) {
  const Scene scene = load_scene(file);
  double began_s = now_s();
  SceneDescription description = testing::describe(scene);
  const double described_s = now_s() - began_s;
  began_s = now_s();
  const auto packed = description.pack();
  std::printf("%u objects, %llu triangles, %.1f MB; described in %.3f s, packed in %.3f s\n",
              packed->offer.object_count, static_cast<unsigned long long>(packed->offer.triangle_count),
              1e-6 * static_cast<double>(packed->bytes.size()), described_s, now_s() - began_s);
  for (int round = 0; round < 5; ++round) {
    const double copy_s = plain_copy_s(packed->bytes);
    testing::ServiceThread daemon({512, 384});
    CullingClient first = client_of(daemon.endpoint(), packed);
    const auto [sent_s, ready_s] = upload_s(first);
    CullingClient second = client_of(daemon.endpoint(), packed);
    const double second_s = upload_s(second).second;
    std::printf("copy %.3f s; uploaded %.3f s (%.2fx), ready %.3f s; a second client ready in %.1f ms\n",
                copy_s, sent_s, sent_s / copy_s, ready_s, 1e3 * second_s);
  }
  return 0;
}

}  // namespace
}  // namespace sightline

int main(int argc, char** argv) {
  if (argc == 2) return sightline::run(argv[1]);
  std::fprintf(stderr, "usage: bench_upload FILE\n");
  return 2;
}
