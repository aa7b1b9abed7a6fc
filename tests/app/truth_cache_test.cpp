#include "main_view/app/truth_cache.hpp"

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "tests/common/test_scenes.hpp"

namespace sightline {
namespace {

const std::vector<ObjectId> k_some = {ObjectId{0}, ObjectId{3}, ObjectId{99}};

TruthCache::Subject subject() {
  return {.scene = {1, 2, 3}, .object_count = 100, .size = {160, 120}, .opengl = "a driver"};
}

std::vector<Eye> eyes(double x_m) {
  Eye eye;
  eye.camera_from_world[3][0] = x_m;
  return {eye};
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class TruthCacheFile : public ::testing::Test {
 protected:
  void write_one() {
    TruthCache cache(file_, subject());
    cache.add(eyes(1.0), k_some);
    cache.add(eyes(2.0), {});
    cache.save();
  }

  testing::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "views.truth";
};

TEST_F(TruthCacheFile, GivesBackWhatWasFoundForTheVerySameEyes) {
  write_one();
  const TruthCache cache(file_, subject());
  ASSERT_NE(cache.find(eyes(1.0)), nullptr);
  EXPECT_EQ(*cache.find(eyes(1.0)), k_some);
  ASSERT_NE(cache.find(eyes(2.0)), nullptr);
  EXPECT_TRUE(cache.find(eyes(2.0))->empty());
  EXPECT_EQ(cache.find(eyes(std::nextafter(1.0, 2.0))), nullptr);
  std::vector<Eye> two = eyes(1.0);
  two.push_back(two.front());
  EXPECT_EQ(cache.find(two), nullptr);
}

TEST_F(TruthCacheFile, IsOfOneSceneSizeAndDriver) {
  write_one();
  TruthCache::Subject other = subject();
  other.scene[5] = 7;
  EXPECT_EQ(TruthCache(file_, other).find(eyes(1.0)), nullptr);
  other = subject();
  other.size.width = 161;
  EXPECT_EQ(TruthCache(file_, other).find(eyes(1.0)), nullptr);
  other = subject();
  other.opengl = "another";
  EXPECT_EQ(TruthCache(file_, other).find(eyes(1.0)), nullptr);
}

TEST_F(TruthCacheFile, KeepsWhatAnotherWroteMeanwhile) {
  TruthCache slow(file_, subject());
  slow.add(eyes(7.0), k_some);
  write_one();
  slow.save();
  const TruthCache cache(file_, subject());
  EXPECT_NE(cache.find(eyes(1.0)), nullptr);
  EXPECT_NE(cache.find(eyes(7.0)), nullptr);
}

TEST_F(TruthCacheFile, WithoutANameKeepsNothing) {
  TruthCache cache({}, subject());
  cache.add(eyes(1.0), k_some);
  EXPECT_EQ(cache.find(eyes(1.0)), nullptr);
  EXPECT_NO_THROW(cache.save());
}

TEST_F(TruthCacheFile, RefusesEveryProperPrefixAndForeignFiles) {
  {
    TruthCache cache(file_, subject());
    cache.add(eyes(1.0), k_some);
    cache.save();
  }
  const std::string whole = bytes_of(file_);
  const std::size_t header = whole.find('\n') + 1;
  for (std::size_t length = header + 1; length < whole.size(); ++length) {
    std::ofstream(file_, std::ios::binary) << whole.substr(0, length);
    EXPECT_THROW(TruthCache(file_, subject()), InputError) << length;
  }
  std::ofstream(file_, std::ios::binary) << "t,px,py,pz\n";
  EXPECT_THROW(TruthCache(file_, subject()), InputError);
}

TEST_F(TruthCacheFile, RefusesObjectsThatTheSceneHasNot) {
  write_one();
  TruthCache::Subject smaller = subject();
  smaller.object_count = 99;
  EXPECT_THROW(TruthCache(file_, smaller), InputError);
}

TEST_F(TruthCacheFile, RefusesCountsThatNoFileHolds) {
  write_one();
  std::string bytes = bytes_of(file_);
  const std::size_t header = bytes.find('\n') + 1;
  for (std::size_t i = 0; i < 8; ++i) bytes[header + i] = '\xff';
  std::ofstream(file_, std::ios::binary) << bytes;
  EXPECT_THROW(TruthCache(file_, subject()), InputError);
}

}  // namespace
}  // namespace sightline
