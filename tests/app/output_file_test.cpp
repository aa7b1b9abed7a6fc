#include "main_view/app/output_file.hpp"

#include <fstream>
#include <ostream>
#include <stdexcept>

#include <gtest/gtest.h>
#include <unistd.h>

#include "common/error.hpp"
#include "main_view/app/play_report.hpp"
#include "tests/common/test_scenes.hpp"

namespace sightline {
namespace {

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(OutputFile, IsCheckedWithoutMakingFolders) {
  const testing::TemporaryFolder folder;
  EXPECT_NO_THROW(require_writable(folder / "new/and new/report.json", "--json"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  std::ofstream(folder / "file") << "x";
  EXPECT_NO_THROW(require_writable(folder / "file", "--json"));
  EXPECT_THROW(require_writable(folder / "file/report.json", "--json"), InputError);
  EXPECT_THROW(require_writable(folder.path(), "--json"), InputError);
  EXPECT_THROW(require_writable("/dev/null", "--json"), InputError);
}

TEST(OutputFile, RefusesAFolderWithoutTheRight) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write anywhere";
  const testing::TemporaryFolder folder;
  using std::filesystem::perms;
  std::filesystem::permissions(folder.path(), perms::owner_read | perms::owner_exec);
  EXPECT_THROW(require_writable(folder / "report.json", "--json"), InputError);
  EXPECT_THROW(require_writable(folder / "new/report.json", "--json"), InputError);
  std::filesystem::permissions(folder.path(), perms::owner_all);
}

TEST(OutputFile, IsWrittenWholeOrNotAtAll) {
  const testing::TemporaryFolder folder;
  const auto file = folder / "new/report.json";
  write_whole_text(file, [](std::ostream& out) { out << "old"; });
  EXPECT_EQ(text_of(file), "old");
  EXPECT_THROW(write_whole_text(file,
                                [](std::ostream& out) {
                                  out << "half of the new";
                                  throw std::runtime_error("the rest is lost");
                                }),
               std::runtime_error);
  EXPECT_EQ(text_of(file), "old");
  const std::filesystem::directory_iterator files(folder / "new");
  EXPECT_EQ(std::distance(begin(files), end(files)), 1);
}

TEST(PlayReport, WritesTheFramesThatAllRunsHave) {
  const testing::TemporaryFolder folder;
  const std::vector<PlayRun> runs = {{CullingMode::service, {{0, 0.001, 1, 2}, {1, 0.002, 3, 4}}},
                                     {CullingMode::frustum, {{0, 0.003, 5, 6}}}};
  write_frames_csv(folder / "frames.csv", runs);
  EXPECT_EQ(
      text_of(folder / "frames.csv"),
      "frame,service_ms,service_objects,service_triangles,frustum_ms,frustum_objects,frustum_triangles\n"
      "0,1,1,2,3,5,6\n");
}

}  // namespace
}  // namespace sightline
