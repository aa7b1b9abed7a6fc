// Bad input: one line on standard error that names what is wrong, the right exit code, nothing half done.

#include <algorithm>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/integration/scenario.hpp"

namespace sightline {
namespace {

using namespace testing;

class BadInput : public ::testing::Test {
 protected:
  /// Expects `command` to end with `exit_code` and one line that names `named`.
  static void expect_refusal(const std::vector<std::string>& command, int exit_code,
                             const std::string& named) {
    const Finished finished = run(command, 60.0);
    EXPECT_EQ(finished.exit_code, exit_code) << finished.err;
    EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
    EXPECT_NE(finished.err.find(named), std::string::npos) << finished.err;
    EXPECT_EQ(finished.out, "");
  }

  std::string write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }

  [[nodiscard]] std::vector<std::string> audit_of(const std::string& scene, const std::string& path) const {
    return {main_view_executable(),
            "audit",
            "--spawn",
            "--scene",
            scene,
            "--path",
            path,
            "--json",
            (folder_ / "report.json").string()};
  }

  TemporaryFolder folder_;
  const std::string header_ = "t,px,py,pz,qw,qx,qy,qz\n";
};

TEST_F(BadInput, MissingSceneIsNamed) {
  expect_refusal({main_view_executable(), "info", "--scene", "no/such.glb"}, 2, "no/such.glb");
  expect_refusal(
      {control_view_executable(), "serve", "--bind", "tcp://127.0.0.1:*", "--scene", "no/such.glb"}, 2,
      "no/such.glb");
}

TEST_F(BadInput, TruncatedAndLyingScenesAreNamed) {
  const auto whole = scenes_folder() / "clinic_ground.glb";
  std::ifstream in(whole, std::ios::binary);
  std::string bytes(2000, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  expect_refusal({main_view_executable(), "info", "--scene", write("cut.glb", bytes)}, 2, "cut.glb");
  expect_refusal({main_view_executable(), "info", "--scene",
                  write("liar.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":10000000000,
                        "uri":"data:application/octet-stream;base64,AAAA"}]})")},
                 2, "liar.gltf");
}

TEST_F(BadInput, ABrokenPathNamesItsLine) {
  const std::string scene = (scenes_folder() / "clinic_ground.glb").string();
  expect_refusal(audit_of(scene, write("bad.csv", header_ + "0,0,0,0,1,0,0,0\n1,0,zero,0,1,0,0,0\n")), 2,
                 "bad.csv: line 3");
  expect_refusal(audit_of(scene, write("empty.csv", header_)), 2, "empty.csv");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "report.json"));
}

TEST_F(BadInput, AnUnknownEngineIsNamed) {
  const std::string scene = (scenes_folder() / "clinic_ground.glb").string();
  expect_refusal({control_view_executable(), "serve", "--bind", "tcp://127.0.0.1:*", "--scene", scene,
                  "--engine", "crystal_ball"},
                 2, "crystal_ball");
}

TEST_F(BadInput, ImpossibleSizesAreRefused) {
  for (const char* size : {"0x0", "0x384", "1000000x1000000", "512", "x", "-1x5"}) {
    SCOPED_TRACE(size);
    expect_refusal({control_view_executable(), "serve", "--bind", "tcp://127.0.0.1:*", "--scene", "x.glb",
                    "--size", size},
                   2, "size");
    expect_refusal({main_view_executable(), "play", "--spawn", "--headless", "--scene", "x.glb", "--path",
                    "x.csv", "--size", size},
                   2, "size");
  }
}

TEST_F(BadInput, AnEndpointInUseIsNamed) {
  const std::string scene = (scenes_folder() / "clinic_ground.glb").string();
  const Daemon first({"--scene", scene});
  const Finished second =
      run({control_view_executable(), "serve", "--bind", first.endpoint(), "--scene", scene});
  EXPECT_EQ(second.exit_code, 3);
  EXPECT_NE(second.err.find(first.endpoint()), std::string::npos) << second.err;
}

TEST_F(BadInput, ADaemonThatIsNotThereIsNamed) {
  expect_refusal({control_view_executable(), "ping", "--connect", "tcp://127.0.0.1:9", "--timeout", "0.5"}, 1,
                 "tcp://127.0.0.1:9");
}

TEST_F(BadInput, ADaemonWithAnotherSceneIsNotUsed) {
  const Scenario city = small_city();
  const Daemon daemon({"--scene", (scenes_folder() / "clinic_ground.glb").string()});
  const Finished audit =
      run({main_view_executable(), "audit", "--connect", daemon.endpoint(), "--scene", city.scene_file(),
           "--path", city.path_file(), "--frames", "2", "--json", (folder_ / "report.json").string()});
  EXPECT_EQ(audit.exit_code, 2);
  EXPECT_NE(audit.err.find("scene"), std::string::npos) << audit.err;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "report.json"));
}

}  // namespace
}  // namespace sightline
