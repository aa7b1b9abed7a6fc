#include "main_view/app/command_line.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/scene/write_glb.hpp"
#include "main_view/app/generate_command.hpp"
#include "main_view/app/info_command.hpp"
#include "tests/common/test_scenes.hpp"

namespace sightline {
namespace {

struct Outcome {
  int code = -1;
  std::string out, error;
};

Outcome run(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "main_view");
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  Outcome outcome;
  outcome.code = run_command_line(int(arguments.size()), arguments.data());
  outcome.out = ::testing::internal::GetCapturedStdout();
  outcome.error = ::testing::internal::GetCapturedStderr();
  return outcome;
}

void expect_one_line(const Outcome& outcome, int code, const std::string& names) {
  EXPECT_EQ(outcome.code, code);
  EXPECT_EQ(std::count(outcome.error.begin(), outcome.error.end(), '\n'), 1) << outcome.error;
  EXPECT_NE(outcome.error.find(names), std::string::npos) << outcome.error;
}

Scene two_boxes_and_a_pane() {
  testing::SceneBuilder builder;
  const auto stone = builder.add_material(testing::opaque());
  builder.add_box({0, 1, 0}, {2, 2, 2}, stone);
  builder.add_box({8, 1, 0}, {2, 2, 2}, stone);
  builder.add_wall({4, 1, 0}, 2.0, 2.0, builder.add_material(testing::glass()));
  return builder.finish();
}

TEST(CommandLine, HelpAndVersionSucceed) {
  EXPECT_EQ(run({"--help"}).code, 0);
  EXPECT_EQ(run({"play", "--help"}).code, 0);
  const Outcome version = run({"--version"});
  EXPECT_EQ(version.code, 0);
  EXPECT_NE(version.out.find("main_view"), std::string::npos);
}

TEST(CommandLine, RefusesWhatItDoesNotKnowInOneLine) {
  expect_one_line(run({}), 2, "subcommand");
  expect_one_line(run({"dance"}), 2, "");
  expect_one_line(run({"play", "--scene", "a.glb"}), 2, "--path");
  expect_one_line(run({"info", "--scene", "a.glb", "--nonsense"}), 2, "--nonsense");
  expect_one_line(run({"info", "--scene", "no such file.glb"}), 2, "no such file.glb");
}

TEST(CommandLine, NamesTheOptionThatIsWrong) {
  const auto play = [](std::vector<const char*> more) {
    std::vector<const char*> arguments{"play", "--scene", "a.glb", "--path", "a.csv", "--spawn"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(std::move(arguments));
  };
  expect_one_line(play({"--size", "0x0"}), 2, "--size");
  expect_one_line(play({"--size", "1000000x1000000"}), 2, "--size");
  expect_one_line(play({"--size", "big"}), 2, "--size");
  expect_one_line(play({"--rate", "0"}), 2, "--rate");
  expect_one_line(play({"--rate", "nan"}), 2, "--rate");
  expect_one_line(play({"--frames", "0"}), 2, "--frames");
  expect_one_line(play({"--frames", "-3"}), 2, "--frames");
  expect_one_line(play({"--culling", "some"}), 2, "--culling");
  expect_one_line(play({"--near", "-1"}), 2, "--near");
  expect_one_line(play({"--connect", "tcp://127.0.0.1:1"}), 2, "--connect");
  expect_one_line(play({"--guard", "90"}), 2, "--guard");
  expect_one_line(run({"audit", "--scene", "a.glb", "--path", "a.csv", "--json", "r.json"}), 2, "--spawn");
  expect_one_line(
      run({"audit", "--scene", "a.glb", "--path", "a.csv", "--json", "r.json", "--spawn", "--latency", "-1"}),
      2, "--latency");
}

TEST(InfoCommand, PrintsObjectsTrianglesExtentsAndDigest) {
  const testing::TemporaryFolder folder;
  const Scene scene = two_boxes_and_a_pane();
  const auto file = folder / "scene.glb";
  write_glb(file, scene);
  const Outcome outcome = run({"info", "--scene", file.c_str()});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.out.find("objects     3\n"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("triangles   26\n"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("10.00 2.00 2.00 m"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find(std::string("digest      ").append(to_hex(scene.digest))), std::string::npos)
      << outcome.out;
  EXPECT_NE(outcome.out.find("blended     1 objects"), std::string::npos) << outcome.out;
}

TEST(InfoCommand, GivesTheSameAsJson) {
  const auto json = nlohmann::json::parse(describe_scene_as_json(two_boxes_and_a_pane()));
  EXPECT_EQ(json["objects"], 3);
  EXPECT_EQ(json["triangles"], 26);
  EXPECT_EQ(json["blended_objects"], 1);
  EXPECT_NEAR(json["extents_m"][0].get<double>(), 10.0, 1e-4);
}

TEST(GenerateCommand, WritesTheSameBytesForTheSameSeed) {
  const testing::TemporaryFolder folder;
  std::ostringstream log;
  const auto bytes = [](const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  for (const char* name : {"a", "b"}) {
    GenerateOptions options{"city", 60, 5, folder / std::string(name).append(".glb"),
                            folder / std::string(name).append(".csv")};
    EXPECT_EQ(run_generate(options, log), ExitCode::done);
  }
  EXPECT_FALSE(bytes(folder / "a.glb").empty());
  EXPECT_EQ(bytes(folder / "a.glb"), bytes(folder / "b.glb"));
  EXPECT_EQ(bytes(folder / "a.csv"), bytes(folder / "b.csv"));
  EXPECT_NE(log.str().find("60 objects"), std::string::npos);
}

TEST(GenerateCommand, LeavesNothingBehindWhenOneOfItsFilesCannotBeWritten) {
  const testing::TemporaryFolder folder;
  const auto scene = folder / "new/scene.glb";
  expect_one_line(run({"generate", "city", "--objects", "5", "--out", scene.c_str(), "--path-out",
                       folder.path().c_str()}),
                  2, "--path-out");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(GenerateCommand, RefusesKindsAndCountsItDoesNotHave) {
  const testing::TemporaryFolder folder;
  const auto file = folder / "scene.glb";
  expect_one_line(run({"generate", "village", "--objects", "5", "--out", file.c_str()}), 2, "village");
  expect_one_line(run({"generate", "city", "--objects", "0", "--out", file.c_str()}), 2, "--objects");
  expect_one_line(run({"generate", "city", "--objects", "5", "--out", "scene.txt"}), 2, "--out");
  EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace sightline
