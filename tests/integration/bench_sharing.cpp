// What sharing a daemon costs: a scene's upload against a plain copy of its bytes, the second client of it,
// and many sessions on one scene, one of which may have stopped reading. Prints one line a figure.
//
//   bench_sharing SCENE [PATH.csv] [sessions]
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "common/camera_path.hpp"
#include "common/pose.hpp"
#include "common/scene/load_scene.hpp"
#include "main_view/client/scene_upload.hpp"
#include "protocol/codec.hpp"
#include "protocol/endpoint_link.hpp"
#include "tests/control_view/scene_data_of.hpp"
#include "tests/integration/process.hpp"

namespace sightline::testing {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int k_rounds = 7;
constexpr double k_limit_s = 120.0;

double now_s() {
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

/// User and system time that a process has used, all its threads.
double cpu_s(pid_t process) {
  clockid_t clock{};
  timespec used{};
  if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &used) != 0)
    throw std::runtime_error("no clock of process " + std::to_string(process));
  return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0 : values[values.size() / 2];
}

double share(std::vector<double> values, double part) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0
                        : values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

/// Seconds from the first byte to the receiver's word that it has the last. `copy` is memory that was used
/// before: taking it from the system fresh, as the daemon has to, takes about as long again.
double plain_copy_s(std::span<const std::uint8_t> bytes, std::span<std::uint8_t> copy) {
  const int listener = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof(address);
  if (bind(listener, reinterpret_cast<sockaddr*>(&address), length) != 0 || listen(listener, 1) != 0)
    throw std::runtime_error("no loopback socket");
  getsockname(listener, reinterpret_cast<sockaddr*>(&address), &length);
  std::thread receiver([&] {
    const int peer = accept(listener, nullptr, nullptr);
    std::size_t got = 0;
    while (got < copy.size()) {
      const ssize_t some = read(peer, copy.data() + got, copy.size() - got);
      if (some <= 0) break;
      got += static_cast<std::size_t>(some);
    }
    const char done = got == copy.size() ? 1 : 0;
    if (write(peer, &done, 1) != 1) std::perror("plain copy");
    close(peer);
  });
  const int sender = socket(AF_INET, SOCK_STREAM, 0);
  if (connect(sender, reinterpret_cast<sockaddr*>(&address), length) != 0)
    throw std::runtime_error("no loopback connection");
  const double began_s = now_s();
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t some = write(sender, bytes.data() + sent, bytes.size() - sent);
    if (some <= 0) throw std::runtime_error("loopback copy broke off");
    sent += static_cast<std::size_t>(some);
  }
  char done = 0;
  if (read(sender, &done, 1) != 1 || done != 1) throw std::runtime_error("loopback copy broke off");
  const double took_s = now_s() - began_s;
  receiver.join();
  close(sender);
  close(listener);
  return took_s;
}

std::shared_ptr<const PackedScene> packed(const Scene& scene) {
  auto result = std::make_shared<PackedScene>();
  const SceneData data = test::scene_data_of(scene);
  const double began_s = now_s();
  result->bytes = encode_scene_data(data);
  const double packed_s = now_s();
  result->offer =
      offer_of(result->bytes, static_cast<std::uint32_t>(data.object_count()), data.triangle_count());
  result->objects.digest = result->offer.scene_digest;
  std::printf("scene: %u objects, %llu triangles, %.1f MB; packed in %.1f ms, digest in %.1f ms\n",
              result->offer.object_count, static_cast<unsigned long long>(result->offer.triangle_count),
              1e-6 * static_cast<double>(result->bytes.size()), 1e3 * (packed_s - began_s),
              1e3 * (now_s() - packed_s));
  return result;
}

/// Until `done`, in bounded time.
template <class Done>
void pump(SceneUpload& upload, Done done) {
  for (const double end_s = now_s() + k_limit_s; now_s() < end_s;) {
    const SceneUpload::State state = upload.poll(now_s());
    if (state == SceneUpload::State::failed) throw std::runtime_error("upload failed: " + upload.text());
    if (done(state)) return;
    upload.wait(0.001);
  }
  throw std::runtime_error("the upload took too long");
}

bool all_held(SceneUpload::State state) {
  return state == SceneUpload::State::building || state == SceneUpload::State::ready;
}
bool is_ready(SceneUpload::State state) {
  return state == SceneUpload::State::ready;
}

Welcome open_session(ClientLink& link, const SceneDigest& digest) {
  link.send(encode(Hello{k_protocol_version, "bench", digest}));
  for (const double end_s = now_s() + k_limit_s; now_s() < end_s;) {
    const auto frame = link.receive(std::chrono::milliseconds(100));
    if (!frame) continue;
    auto decoded = decode(*frame);
    if (const auto* message = std::get_if<Message>(&decoded)) {
      if (const auto* welcome = std::get_if<Welcome>(message)) return *welcome;
    }
  }
  throw std::runtime_error("no Welcome");
}

/// What one way took in each round.
struct Times {
  std::vector<double> wall_s, client_s, daemon_s;  ///< the last two: processor time
};

/// "NAME: 40.0 ms (38.1 to 45.2), processor time 20.1 + 30.2 ms"
void print(const char* name, const Times& times) {
  std::printf("%s: %.1f ms (%.1f to %.1f)", name, 1e3 * median(times.wall_s), 1e3 * share(times.wall_s, 0.0),
              1e3 * share(times.wall_s, 1.0));
  if (!times.client_s.empty()) std::printf(", processor time %.1f", 1e3 * median(times.client_s));
  if (!times.daemon_s.empty()) std::printf(" + %.1f", 1e3 * median(times.daemon_s));
  std::printf(times.client_s.empty() ? "\n" : " ms\n");
}

/// Notes in `times` what passed since it was made, when told to.
class Lap {
 public:
  explicit Lap(pid_t daemon = -1) : daemon_(daemon) {}
  void note(Times& times) const {
    times.wall_s.push_back(now_s() - began_s_);
    times.client_s.push_back(cpu_s(getpid()) - client_s_);
    if (daemon_ >= 0) times.daemon_s.push_back(cpu_s(daemon_) - daemon_s_);
  }

 private:
  pid_t daemon_;
  double client_s_ = cpu_s(getpid()), daemon_s_ = daemon_ < 0 ? 0.0 : cpu_s(daemon_), began_s_ = now_s();
};

void bench_upload(const std::shared_ptr<const PackedScene>& scene) {
  Times plain, held, ready, second;
  std::vector<double> ratio, resumed_share;
  std::vector<std::uint8_t> copy(scene->bytes.size());
  for (int round = 0; round < k_rounds; ++round) {
    {
      const Lap lap;
      const double took_s = plain_copy_s(scene->bytes, copy);
      lap.note(plain);
      plain.wall_s.back() = took_s;
    }
    {
      Daemon daemon({"--log", "error"});
      const Lap lap(daemon.process_id());
      SceneUpload upload(daemon.endpoint(), {}, scene, 0.25);
      pump(upload, all_held);
      lap.note(held);
      pump(upload, is_ready);
      lap.note(ready);
      ratio.push_back(held.wall_s.back() / plain.wall_s.back());

      const Lap second_lap(daemon.process_id());
      SceneUpload same(daemon.endpoint(), {}, scene, 0.25);
      pump(same, is_ready);
      ClientLink link(daemon.endpoint());
      (void)open_session(link, scene->offer.scene_digest);
      second_lap.note(second);
    }
    {
      Daemon daemon({"--log", "error"});
      {
        SceneUpload first(daemon.endpoint(), {}, scene, 0.25);
        pump(first, [&](auto) { return 2 * first.progress().bytes_held >= first.progress().bytes_total; });
      }  // as a kill: the connection goes with what was on its way
      SceneUpload again(daemon.endpoint(), {}, scene, 0.25);
      pump(again, all_held);
      resumed_share.push_back(static_cast<double>(again.progress().bytes_sent) /
                              static_cast<double>(scene->bytes.size()));
    }
  }
  print("plain copy over loopback", plain);
  print("upload, until the daemon has all", held);
  std::printf("  %.2f times the plain copy (%.2f to %.2f in one round)\n",
              median(held.wall_s) / median(plain.wall_s), share(ratio, 0.0), share(ratio, 1.0));
  print("upload, until it is ready (digests checked, engine made)", ready);
  std::printf("resumed after half: %.2f of the bytes sent again or for the first time\n",
              median(resumed_share));
  print("second client, same scene, until its session is open", second);
}

/// One that always has a request on its way.
struct Busy {
  Busy(const std::string& endpoint, const SceneDigest& digest, double phase_s)
      : link(endpoint), offset_s(phase_s) {
    session_id = open_session(link, digest).session_id;
  }
  void ask(const CameraPath& path) {
    ViewRequest request;
    request.session_id = session_id;
    request.request_seq = ++seq;
    const double t = std::fmod(offset_s + 0.02 * static_cast<double>(seq), path.duration_s());
    request.for_time_s = 0.02 * static_cast<double>(seq);
    request.eyes = {{camera_from_world(path.at(path.samples.front().time_s + t)),
                     clip_from_camera(Perspective{}, 4.0 / 3.0)}};
    request.main_size = {1024, 768};
    request.rotation_error_rad = 0.17;
    request.position_error_m = 0.05;
    request.acked_set_seq = acked;
    asked_s = now_s();
    link.send(encode(request));
  }
  /// Whether an answer has come.
  bool take() {
    const auto frame = link.receive(std::chrono::milliseconds(0));
    if (!frame) return false;
    auto decoded = decode(*frame);
    const auto* message = std::get_if<Message>(&decoded);
    const auto* set = message == nullptr ? nullptr : std::get_if<VisibleSetFrame>(message);
    if (set == nullptr) return false;
    acked = set->set_seq;
    latencies_s.push_back(now_s() - asked_s);
    return true;
  }

  ClientLink link;
  double offset_s;
  std::uint64_t session_id = 0, seq = 0, acked = 0;
  double asked_s = 0.0;
  std::vector<double> latencies_s;
};

/// Runs sessions for a while. `stalled` of them ask all the time and never read.
void drive(std::vector<std::unique_ptr<Busy>>& sessions, std::size_t stalled, const CameraPath& path,
           double duration_s) {
  for (auto& session : sessions) {
    session->latencies_s.clear();
    session->ask(path);
  }
  for (const double end_s = now_s() + duration_s; now_s() < end_s;) {
    bool any = false;
    for (std::size_t i = 0; i < sessions.size(); ++i) {
      if (i < stalled) {
        if (now_s() - sessions[i]->asked_s > 0.01) sessions[i]->ask(path);
        continue;
      }
      if (!sessions[i]->take()) continue;
      any = true;
      sessions[i]->ask(path);
    }
    if (!any) std::this_thread::sleep_for(std::chrono::microseconds(50));
  }
}

double resident_mib(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmRSS:", 0) == 0) return std::strtod(line.c_str() + 6, nullptr) / 1024.0;
  }
  return 0.0;
}

void bench_sessions(const std::shared_ptr<const PackedScene>& scene, const CameraPath& path,
                    std::size_t count) {
  Daemon daemon({"--log", "error", "--max-sessions", "64"});
  SceneUpload upload(daemon.endpoint(), {}, scene, 0.25);
  pump(upload, is_ready);
  std::vector<std::unique_ptr<Busy>> sessions;
  const auto open = [&](std::size_t wanted) {
    while (sessions.size() < wanted) {
      sessions.push_back(std::make_unique<Busy>(daemon.endpoint(), scene->offer.scene_digest,
                                                1.7 * static_cast<double>(sessions.size())));
    }
  };
  open(1);
  drive(sessions, 0, path, 2.0);
  const double alone_mib = resident_mib(daemon.process_id());
  open(count);
  drive(sessions, 0, path, 6.0);
  std::vector<double> answers;
  for (const auto& session : sessions)
    answers.push_back(static_cast<double>(session->latencies_s.size()) / 6.0);
  double sum = 0.0;
  for (const double rate : answers) sum += rate;
  const double fair = sum / static_cast<double>(answers.size());
  std::printf("%zu sessions: %.1f answers a second each, slowest %.3f and fastest %.3f of the fair share\n",
              count, fair, *std::min_element(answers.begin(), answers.end()) / fair,
              *std::max_element(answers.begin(), answers.end()) / fair);
  std::printf("resident memory of the daemon: %.1f MiB with 1 session, %.1f MiB with %zu\n", alone_mib,
              resident_mib(daemon.process_id()), count);

  // The same sessions, the first reading or not, in turn.
  std::array<std::vector<double>, 2> p50, p99;
  for (int round = 0; round < k_rounds; ++round) {
    for (const std::size_t stalled : {0u, 1u}) {
      drive(sessions, stalled, path, 2.0);
      std::vector<double> all;
      for (std::size_t i = 1; i < sessions.size(); ++i)
        all.insert(all.end(), sessions[i]->latencies_s.begin(), sessions[i]->latencies_s.end());
      p50[stalled].push_back(share(all, 0.5));
      p99[stalled].push_back(share(all, 0.99));
      while (sessions[0]->take()) {
      }
    }
  }
  std::printf(
      "latency of the other %zu sessions: p50 %.2f ms, p99 %.2f ms; with the first stalled p50 %.2f ms, p99 "
      "%.2f ms\n",
      count - 1, 1e3 * median(p50[0]), 1e3 * median(p99[0]), 1e3 * median(p50[1]), 1e3 * median(p99[1]));
}

int main_of(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: bench_sharing SCENE [PATH.csv] [sessions]\n");
    return 2;
  }
  const auto scene = packed(load_scene(argv[1], {.shading = false}));
  bench_upload(scene);
  if (argc > 2) bench_sessions(scene, read_camera_path(argv[2]), argc > 3 ? std::stoul(argv[3]) : 16);
  return 0;
}

}  // namespace
}  // namespace sightline::testing

int main(int argc, char** argv) {
  try {
    return sightline::testing::main_of(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_sharing: %s\n", error.what());
    return 2;
  }
}
