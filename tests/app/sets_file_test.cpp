#include "main_view/app/sets_file.hpp"

#include <fstream>

#include <gmock/gmock.h>

#include "common/error.hpp"
#include "tests/common/test_scenes.hpp"

namespace sightline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class SetsFile : public ::testing::Test {
 protected:
  std::vector<FrameSet> read(const std::string& text) {
    std::ofstream(folder_ / "sets.csv") << text;
    return read_frame_sets(folder_ / "sets.csv", 100, 50);
  }

  void expect_refused(const std::string& text, const std::string& why) {
    try {
      (void)read(text);
      FAIL() << text;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("sets.csv: " + why)) << text;
    }
  }

  testing::TemporaryFolder folder_;
};

TEST_F(SetsFile, HoldsAFrameALineWithIdsInAnyOrder) {
  const std::vector<FrameSet> sets = read("frame,ids\n0,7 3 49 3\n5,\r\n99,*\n");
  ASSERT_EQ(sets.size(), 3u);
  EXPECT_THAT(sets[0].ids, ElementsAre(ObjectId{3}, ObjectId{7}, ObjectId{49}));
  EXPECT_FALSE(sets[0].everything);
  EXPECT_EQ(sets[1].frame, 5u);
  EXPECT_THAT(sets[1].ids, IsEmpty());
  EXPECT_FALSE(sets[1].everything);
  EXPECT_EQ(sets[2].frame, 99u);
  EXPECT_TRUE(sets[2].everything);
}

TEST_F(SetsFile, IsRefusedByTheLineThatIsWrong) {
  expect_refused("", "line 1: the header");
  expect_refused("frames,ids\n", "line 1: the header");
  expect_refused("frame,ids\n", "line 2: holds no set");
  expect_refused("frame,ids\n\n", "line 2: the frame");
  expect_refused("frame,ids\n100,1\n", "line 2: the frame must be a number below 100");
  expect_refused("frame,ids\n-1,1\n", "line 2: the frame");
  expect_refused("frame,ids\n0 1\n", "line 2: a comma");
  expect_refused("frame,ids\n0", "line 2: a comma");
  expect_refused("frame,ids\n0,1\n0,1\n", "line 3: frames do not ascend");
  expect_refused("frame,ids\n0,50\n", "line 2: an id must be a number below 50");
  expect_refused("frame,ids\n0,99999999999999999999\n", "line 2: an id");
  expect_refused("frame,ids\n0,1  2\n", "line 2: an id");
  expect_refused("frame,ids\n0,1 \n", "line 2: an id");
  expect_refused("frame,ids\n0,1;2\n", "line 2: ids must have one space");
  expect_refused("frame,ids\n0,**\n", "line 2: an id");
}

TEST_F(SetsFile, ThatIsNotThereIsRefused) {
  EXPECT_THROW((void)read_frame_sets(folder_ / "none.csv", 1, 1), InputError);
}

}  // namespace
}  // namespace sightline
