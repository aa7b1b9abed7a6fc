#include "common/camera_path.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "tests/common/glb_file.hpp"
#include "tests/common/test_scenes.hpp"

namespace sightline {
namespace {

constexpr const char* k_header = "t,px,py,pz,qw,qx,qy,qz\n";

std::string refusal_of(const std::string& text) {
  const testing::TemporaryFolder folder;
  testing::write_text(folder / "path.csv", text);
  try {
    (void)read_camera_path(folder / "path.csv");
  } catch (const InputError& refusal) {
    return refusal.what();
  }
  return "accepted";
}

TEST(CameraPath, ReadsBackWhatItWrote) {
  CameraPath path;
  for (int i = 0; i < 100; ++i) {
    path.samples.push_back(
        {i / 60.0, {{0.1 * i, 1.0 / 3.0, -7e5}, glm::normalize(glm::dquat(1, 0.01 * i, 0.3, 0))}});
  }
  const testing::TemporaryFolder folder;
  write_camera_path(folder / "path.csv", path);
  const CameraPath again = read_camera_path(folder / "path.csv");
  ASSERT_EQ(again.samples.size(), path.samples.size());
  for (std::size_t i = 0; i < path.samples.size(); ++i) {
    EXPECT_EQ(again.samples[i].time_s, path.samples[i].time_s);
    EXPECT_EQ(again.samples[i].pose.position_m, path.samples[i].pose.position_m);
    EXPECT_LT(
        rotation_angle_rad(again.samples[i].pose.world_from_camera, path.samples[i].pose.world_from_camera),
        1e-14);
  }
}

TEST(CameraPath, GivesItsSamplesExactlyAndInterpolatesBetween) {
  CameraPath path;
  path.samples = {{0.0, {{0, 0, 0}, {1, 0, 0, 0}}},
                  {1.0, {{2, 0, 0}, glm::angleAxis(1.0, glm::dvec3(0, 1, 0))}},
                  {2.0, {{2, 4, 0}, -glm::angleAxis(1.0, glm::dvec3(0, 1, 0))}}};
  EXPECT_EQ(path.at(1.0), path.samples[1].pose);
  EXPECT_EQ(path.at(1.0 + 5e-10), path.samples[1].pose);
  EXPECT_EQ(path.at(-1.0), path.samples[0].pose);
  EXPECT_EQ(path.at(9.0), path.samples[2].pose);
  EXPECT_EQ(path.at(0.5).position_m, glm::dvec3(1, 0, 0));
  EXPECT_NEAR(rotation_angle_rad(path.at(0.5).world_from_camera, {1, 0, 0, 0}), 0.5, 1e-12);
  // q and -q are the same orientation: nothing turns in between.
  EXPECT_NEAR(rotation_angle_rad(path.at(1.5).world_from_camera, path.samples[1].pose.world_from_camera), 0.0,
              1e-12);
}

TEST(CameraPath, AcceptsWindowsLineEndsAndATrailingBlankLine) {
  const testing::TemporaryFolder folder;
  testing::write_text(folder / "path.csv", "t,px,py,pz,qw,qx,qy,qz\r\n0,1,2,3,2,0,0,0\r\n\r\n");
  const CameraPath path = read_camera_path(folder / "path.csv");
  ASSERT_EQ(path.samples.size(), 1u);
  EXPECT_EQ(path.samples[0].pose.world_from_camera, glm::dquat(1, 0, 0, 0));  // normalised
}

TEST(CameraPath, NamesTheLineItRefuses) {
  using ::testing::HasSubstr;
  const std::string header = k_header;
  EXPECT_THAT(refusal_of("a,b\n"), HasSubstr("line 1"));
  EXPECT_THAT(refusal_of(header), HasSubstr("no sample"));
  EXPECT_THAT(refusal_of(header + "0,1,2,3,1,0,0\n"), HasSubstr("line 2"));
  EXPECT_THAT(refusal_of(header + "0,1,2,3,1,0,0,0,9\n"), HasSubstr("line 2"));
  EXPECT_THAT(refusal_of(header + "0,1,2,3,1,0,0,0\n1,1,x,3,1,0,0,0\n"), HasSubstr("line 3: column 3"));
  EXPECT_THAT(refusal_of(header + "0,nan,2,3,1,0,0,0\n"), HasSubstr("line 2: column 2"));
  EXPECT_THAT(refusal_of(header + "0,inf,2,3,1,0,0,0\n"), HasSubstr("line 2: column 2"));
  EXPECT_THAT(refusal_of(header + "0,1,2,3,0,0,0,0\n"), HasSubstr("quaternion"));
  EXPECT_THAT(refusal_of(header + "0,1,2,3,1,0,0,0\n0,1,2,3,1,0,0,0\n"), HasSubstr("line 3: the time"));
  EXPECT_THAT(refusal_of(header + "-0.1,1,2,3,1,0,0,0\n"), HasSubstr("line 2: the time"));
  EXPECT_THAT(refusal_of(header + "1700000000,1,2,3,1,0,0,0\n"), HasSubstr("subtract the first"));
  EXPECT_THAT(refusal_of(header + "0,1,2,3,1,0,0,0\n1000001,1,2,3,1,0,0,0\n"), HasSubstr("line 3: the time"));
  EXPECT_EQ(refusal_of(header + "0,1,2,3,1,0,0,0\n1e6,1,2,3,1,0,0,0\n"), "accepted");
  EXPECT_THAT(refusal_of(header + "0,1,2,3,1,0,0,0\n\n1,1,2,3,1,0,0,0\n"), HasSubstr("line 3"));
  EXPECT_THAT(refusal_of(""), HasSubstr("path.csv"));
  EXPECT_THROW((void)read_camera_path("/nonexistent/path.csv"), InputError);
  EXPECT_THROW((void)read_camera_path("/"), InputError);
  EXPECT_THROW(write_camera_path("/nonexistent/path.csv", {}), InputError);
}

TEST(CameraPath, ReadsEverySharedPathAndTrace) {
  const auto shared = testing::shared_folder();
  if (!shared) GTEST_SKIP() << "../shared is absent";
  for (const char* folder : {"scenes", "traces"}) {
    for (const auto& entry : std::filesystem::directory_iterator(*shared / folder)) {
      if (entry.path().extension() == ".csv") {
        EXPECT_NO_THROW((void)read_camera_path(entry.path())) << entry.path();
      }
    }
  }
}

TEST(CameraPath, ReadsTheBundledWalk) {
  const CameraPath path = read_camera_path(testing::scenes_folder() / "clinic.path.csv");
  EXPECT_GT(path.samples.size(), 3590u);
  EXPECT_NEAR(path.duration_s(), 60.0, 0.1);
}

}  // namespace
}  // namespace sightline
