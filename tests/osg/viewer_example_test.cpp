#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include <gtest/gtest.h>

namespace {

/// How often each line occurs, for lines that say something.
std::map<std::string, int> lines_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  EXPECT_TRUE(stream) << file;
  std::map<std::string, int> lines;
  for (std::string line; std::getline(stream, line);) {
    if (line.find_first_not_of(" \t") != std::string::npos && line.rfind("//", 0) != 0) ++lines[line];
  }
  return lines;
}

TEST(OsgViewerExample, NeedsAtMostTwentyMoreLinesForCulling) {
  const std::filesystem::path folder = SIGHTLINE_OSG_EXAMPLE;
  const auto before = lines_of(folder / "osg_viewer.cpp");
  int added = 0;
  for (const auto& [line, count] : lines_of(folder / "osg_viewer_culled.cpp")) {
    const auto found = before.find(line);
    added += count - (found == before.end() ? 0 : found->second);
  }
  RecordProperty("added_lines", added);
  EXPECT_GT(added, 0);
  EXPECT_LE(added, 20);
}

}  // namespace
