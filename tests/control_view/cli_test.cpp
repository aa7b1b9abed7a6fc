// The real executable: exit codes, and errors of one line.

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "control_view/clock.hpp"
#include "protocol/endpoint_link.hpp"
#include "tests/control_view/scratch_folder.hpp"

namespace sightline {
namespace {

using test::read_text;
using test::ScratchFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// A running control_view with its output in files; killed, if it still runs, when the test is over.
class Process {
 public:
  explicit Process(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), SIGHTLINE_CONTROL_VIEW);
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    const int flags = O_WRONLY | O_CREAT | O_TRUNC;
    posix_spawn_file_actions_addopen(&actions, 1, folder_.file("out").c_str(), flags, 0600);
    posix_spawn_file_actions_addopen(&actions, 2, folder_.file("err").c_str(), flags, 0600);
    if (posix_spawn(&pid_, argv[0], &actions, nullptr, argv.data(), environ) != 0) pid_ = -1;
    posix_spawn_file_actions_destroy(&actions);
  }
  ~Process() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// Exit code, or -1 when it has not ended within `limit_s` or was killed.
  int wait(double limit_s = 20.0) {
    int status = 0;
    const bool ended = until(limit_s, [&] { return waitpid(pid_, &status, WNOHANG) == pid_; });
    if (!ended) return -1;
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  void signal(int number) const { kill(pid_, number); }

  /// The endpoint of the line it prints when ready; empty when there is none in time.
  std::string endpoint() {
    const std::string line = "control_view: listening on ";
    std::string text;
    until(20.0,
          [&] { return (text = out()).ends_with("\n") || waitpid(pid_, nullptr, WNOHANG | WNOWAIT) > 0; });
    return text.starts_with(line) ? text.substr(line.size(), text.size() - line.size() - 1) : "";
  }

  [[nodiscard]] std::string out() const { return read_text(folder_.file("out")); }
  [[nodiscard]] std::string err() const { return read_text(folder_.file("err")); }

 private:
  template <class Condition>
  static bool until(double limit_s, Condition done) {
    const Clock clock = steady_clock();
    for (const double end_s = clock() + limit_s; clock() < end_s;) {
      if (done()) return true;
      poll(nullptr, 0, 2);  // nothing to wait on: another process's file or end
    }
    return done();
  }

  ScratchFolder folder_;
  pid_t pid_ = -1;
};

void expect_refusal(const std::vector<std::string>& arguments, int code, const std::string& named) {
  Process process(arguments);
  EXPECT_EQ(process.wait(), code) << ::testing::PrintToString(arguments);
  const std::string error = process.err();
  EXPECT_THAT(error, AllOf(StartsWith("control_view: "), HasSubstr(named)));
  EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 1) << error;
  EXPECT_EQ(process.out(), "");
}

/// One triangle two metres wide, two metres in front of the origin.
std::string triangle_scene(const ScratchFolder& folder) {
  return folder
      .write("triangle.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AACAvwAAgL8AAADAAACAPwAAgL8AAADAAAAAAAAAgD8AAADA"}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[-1,-1,-2],"max":[1,1,-2]}]})")
      .string();
}

TEST(ControlViewCli, RefusesBadInputWithOneLineAndCode2) {
  const ScratchFolder folder;
  const std::string scene = folder.write("x.glb", "").string();
  expect_refusal({"--scene", scene, "--engine", "magic"}, 2, "magic");
  expect_refusal({"--scene", scene, "--counter", "abacus"}, 2, "abacus");
  expect_refusal({"--scene", scene, "--engine", "raster", "--counter", "queries"}, 2, "raster");
  expect_refusal({"--scene", scene, "--threads", "-1"}, 2, "--threads");
  expect_refusal({"--scene", scene, "--size", "0x0"}, 2, "--size");
  expect_refusal({"--scene", scene, "--size", "1000000x1000000"}, 2, "--size");
  expect_refusal({"--scene", triangle_scene(folder), "--bind", "carrier-pigeon"}, 2, "carrier-pigeon");
  expect_refusal({"--scene", "/nowhere/city.glb", "--bind", "tcp://127.0.0.1:*"}, 2, "/nowhere/city.glb");
  expect_refusal({"--scene", scene, "--keys", "/nowhere/keys.toml"}, 2, "/nowhere/keys.toml");
  expect_refusal({"--bind", "tcp://127.0.0.1:*", "--uploads", "off"}, 2, "--scene");
  expect_refusal({"--scene", scene, "--uploads", "perhaps"}, 2, "--uploads");
  expect_refusal({"--scene", scene, "--max-scene-mib", "4096"}, 2, "--max-scene-mib");
  expect_refusal({"--scene", scene, "--max-objects", "0"}, 2, "--max-objects");
  expect_refusal({"--sceen", scene}, 2, "--sceen");
}

TEST(ControlViewCli, RefusesAnEndpointInUseWithCode3) {
  const ServerLink other("tcp://127.0.0.1:*");
  const ScratchFolder folder;
  expect_refusal({"--scene", triangle_scene(folder), "--bind", other.bound_endpoint()}, 3,
                 other.bound_endpoint());
}

TEST(ControlViewCli, ListsItsEngines) {
  Process process({"engines"});
  EXPECT_EQ(process.wait(), 0);
  EXPECT_THAT(process.out(), AllOf(HasSubstr("item_buffer histogram queries compute\n"),
                                   HasSubstr("item_buffer_all histogram queries compute\n"),
                                   HasSubstr("raster\n"), HasSubstr("raycast\n")));
}

TEST(ControlViewCli, ServesPingsAndStopsOnASignal) {
  const ScratchFolder folder;
  for (const int number : {SIGTERM, SIGINT}) {
    Process daemon({"--scene", triangle_scene(folder), "--bind", "tcp://127.0.0.1:*", "--announce",
                    folder.file("endpoint").string()});
    const std::string endpoint = daemon.endpoint();
    ASSERT_NE(endpoint, "") << daemon.err();
    EXPECT_EQ(read_text(folder.file("endpoint")), endpoint + "\n");
    Process ping({"ping", "--connect", endpoint, "--timeout", "10"});
    EXPECT_EQ(ping.wait(), 0) << ping.err();
    daemon.signal(number);
    EXPECT_EQ(daemon.wait(5.0), 0) << daemon.err();
    EXPECT_FALSE(std::filesystem::exists(folder.file("endpoint")));
  }
}

TEST(ControlViewCli, RemovesItsIpcPath) {
  const ScratchFolder folder;
  const std::string path = folder.file("socket").string();
  Process daemon({"--scene", triangle_scene(folder), "--bind", "ipc://" + path});
  ASSERT_EQ(daemon.endpoint(), "ipc://" + path) << daemon.err();
  EXPECT_TRUE(std::filesystem::exists(path));
  daemon.signal(SIGTERM);
  EXPECT_EQ(daemon.wait(5.0), 0);
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(ControlViewCli, PingSaysWhenNobodyAnswers) {
  std::string endpoint;
  {
    const ServerLink gone("tcp://127.0.0.1:*");
    endpoint = gone.bound_endpoint();
  }
  expect_refusal({"ping", "--connect", endpoint, "--timeout", "0.2"}, 1, endpoint);
}

TEST(ControlViewCli, MakesKeysOnlyTheirOwnerCanReadAndNeverTwice) {
  const ScratchFolder folder;
  const std::string file = folder.file("keys.toml").string();
  Process process({"keygen", "--out", file});
  EXPECT_EQ(process.wait(), 0);
  EXPECT_THAT(process.out(), StartsWith("public_key = "));
  struct stat status {};
  ASSERT_EQ(stat(file.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600u);
  const CurveKeys keys = read_curve_keys(file);
  EXPECT_EQ(keys.public_key.size(), 40u);
  EXPECT_EQ(keys.secret_key.size(), 40u);
  const std::string before = read_text(file);
  expect_refusal({"keygen", "--out", file}, 2, file);
  EXPECT_EQ(read_text(file), before);
}

TEST(ControlViewCli, BenchWritesItsReport) {
  const ScratchFolder folder;
  const auto path = folder.write("path.csv", "t,px,py,pz,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n1,0,0,0.5,1,0,0,0\n");
  const std::string json = folder.file("report.json").string();
  Process process({"bench", "--scene", triangle_scene(folder), "--path", path.string(), "--size", "64x48",
                   "--frames", "5", "--engine", "item_buffer,item_buffer:queries", "--json", json});
  ASSERT_EQ(process.wait(), 0) << process.err();
  const std::string report = read_text(json);
  for (const char* field :
       {"\"engines\"", "\"frame_ms\"", "\"p99\"", "\"stages_ms\"", "\"drawn_objects\": 1.0",
        "\"reported\": 1.0", "\"missed\": 0.0", "\"kept\": 0.0", "\"queries\"", "\"load_ms\"", "\"build_ms\"",
        "\"peak_memory_mb\"", "\"instructions\"", "\"oracle\": {", "\"differing_pixels_share\": 0.0"}) {
    EXPECT_THAT(report, HasSubstr(field));
  }
}

TEST(ControlViewCli, BenchLooksThroughSeveralEyesWithEveryEngine) {
  const ScratchFolder folder;
  const auto path = folder.write("path.csv", "t,px,py,pz,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n1,0,0,0.5,1,0,0,0\n");
  for (const char* views : {"stereo", "around", "region"}) {
    const std::string json = folder.file("report.json").string();
    Process process({"bench", "--scene", triangle_scene(folder), "--path", path.string(), "--size", "64x48",
                     "--step", "20", "--lead-in", "0.03", "--threads", "2", "--views", views, "--json",
                     json});
    ASSERT_EQ(process.wait(), 0) << process.err();
    const std::string report = read_text(json);
    EXPECT_THAT(report,
                AllOf(HasSubstr("\"raster\""), HasSubstr("\"raycast\""), HasSubstr("\"item_buffer_all\""),
                      HasSubstr(std::string("\"views\": \"") + views), HasSubstr("\"frames\": 4"),
                      HasSubstr("\"oracle\": null")));
    EXPECT_THAT(report, ::testing::Not(HasSubstr("\"reported\": 0.0")));
  }
}

TEST(ControlViewCli, SaysWhichEngineItChose) {
  const ScratchFolder folder;
  Process daemon({"--scene", triangle_scene(folder), "--bind", "tcp://127.0.0.1:*"});
  ASSERT_NE(daemon.endpoint(), "") << daemon.err();
  daemon.signal(SIGTERM);
  EXPECT_EQ(daemon.wait(5.0), 0);
  EXPECT_THAT(daemon.err(), AllOf(HasSubstr("engine raster chosen"), HasSubstr("ms a view")));
}

TEST(ControlViewCli, BenchRefusesBadInput) {
  const ScratchFolder folder;
  const std::string scene = triangle_scene(folder);
  const std::string path = folder.write("path.csv", "t,px,py,pz,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n").string();
  const std::string json = folder.file("r.json").string();
  expect_refusal({"bench", "--scene", scene, "--path", "/nowhere.csv", "--json", json}, 2, "/nowhere.csv");
  expect_refusal({"bench", "--scene", scene, "--path", path, "--json", "/nowhere/r.json"}, 2,
                 "/nowhere/r.json");
  expect_refusal({"bench", "--scene", scene, "--path", path, "--json", json, "--engine", "magic"}, 2,
                 "magic");
  expect_refusal({"bench", "--scene", scene, "--path", path, "--json", json, "--engine", "auto"}, 2, "auto");
  expect_refusal({"bench", "--scene", scene, "--path", path, "--json", json, "--engine", "raster:queries"}, 2,
                 "raster");
  expect_refusal({"bench", "--scene", scene, "--path", path, "--json", json, "--start", "5"}, 2, "--start");
  expect_refusal({"bench", "--scene", scene, "--path", path, "--json", json, "--views", "up"}, 2, "--views");
  for (const char* time : {"-300", "1e15"}) {
    const std::string header = "t,px,py,pz,qw,qx,qy,qz\n";
    const auto odd = folder.write("odd.csv", header + time + ",0,0,0,1,0,0,0\n").string();
    expect_refusal({"bench", "--scene", scene, "--path", odd, "--json", json}, 2, odd);
  }
}

TEST(ControlViewCli, BenchKeepsTheOldReportWhenItCannotMakeANewOne) {
  const ScratchFolder folder;
  const std::string path = folder.write("path.csv", "t,px,py,pz,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n").string();
  const std::string json = folder.write("report.json", "precious").string();
  const std::string broken = folder.write("broken.gltf", "{").string();
  expect_refusal({"bench", "--scene", broken, "--path", path, "--json", json}, 2, broken);
  EXPECT_EQ(read_text(json), "precious");
}

}  // namespace
}  // namespace sightline
