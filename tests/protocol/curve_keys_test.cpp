#include "protocol/curve_keys.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "common/error.hpp"
#include "temporary_directory.hpp"

namespace sightline {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class CurveKeyFile : public testing::Test {
 protected:
  /// What reading a file with this text fails with.
  std::string error_of(const std::string& text) {
    std::ofstream(file_) << text;
    try {
      (void)read_curve_keys(file_);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), AllOf(HasSubstr(file_), testing::Not(HasSubstr("\n"))));
      return error.what();
    }
    return "read";
  }

  TemporaryDirectory directory_;
  std::string file_ = directory_.file("keys.toml");
};

TEST_F(CurveKeyFile, IsReadAsItWasWritten) {
  CurveKeys keys = make_curve_keys();
  keys.server_public_key = make_curve_keys().public_key;
  write_curve_keys(file_, keys);
  const CurveKeys read = read_curve_keys(file_);
  EXPECT_TRUE(read.enabled());
  EXPECT_EQ(read.public_key, keys.public_key);
  EXPECT_EQ(read.secret_key, keys.secret_key);
  EXPECT_EQ(read.server_public_key, keys.server_public_key);
}

TEST_F(CurveKeyFile, IsForItsOwnerOnlyAndNeverReplaced) {
  const CurveKeys keys = make_curve_keys();
  write_curve_keys(file_, keys);
  struct stat status {};
  ASSERT_EQ(::stat(file_.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600u);
  EXPECT_THROW(write_curve_keys(file_, make_curve_keys()), InputError);
  EXPECT_EQ(read_curve_keys(file_).secret_key, keys.secret_key);
  EXPECT_THROW(write_curve_keys(directory_.file("none/keys.toml"), keys), InputError);
}

TEST_F(CurveKeyFile, RefusesWrongContentNamingTheField) {
  const CurveKeys keys = make_curve_keys();
  const std::string public_line = "public_key = \"" + keys.public_key + "\"\n";
  const std::string secret_line = "secret_key = \"" + keys.secret_key + "\"\n";
  EXPECT_EQ(error_of(public_line + secret_line), "read");
  EXPECT_THAT(error_of(secret_line), HasSubstr("public_key is missing"));
  EXPECT_THAT(error_of(public_line), HasSubstr("secret_key is missing"));
  EXPECT_THAT(error_of(public_line + "secret_key = 5\n"), HasSubstr("secret_key must be"));
  EXPECT_THAT(error_of(public_line + "secret_key = \"short\"\n"), HasSubstr("secret_key must be"));
  EXPECT_THAT(error_of(public_line + "secret_key = \"" + std::string(40, '~') + "\"\n"),
              HasSubstr("secret_key must be"));
  EXPECT_THAT(error_of(public_line + "secret_key = \"" + make_curve_keys().secret_key + "\"\n"),
              HasSubstr("does not belong"));
  EXPECT_THAT(error_of(public_line + secret_line + "server_public_key = \"x\"\n"),
              HasSubstr("server_public_key must be"));
  EXPECT_THAT(error_of(public_line + secret_line + "secret = 1\n"), HasSubstr("unknown field secret"));
  EXPECT_THAT(error_of(public_line + "secret_key = \n"), HasSubstr("line 2"));
  EXPECT_THAT(error_of(""), HasSubstr("empty"));
  EXPECT_THAT(error_of(std::string(100'000, '#')), HasSubstr("too large"));
}

TEST_F(CurveKeyFile, RefusesWhatCannotBeRead) {
  EXPECT_THROW((void)read_curve_keys(directory_.file("none")), InputError);
  EXPECT_THROW((void)read_curve_keys(directory_.file("")), InputError);
  EXPECT_THROW((void)read_curve_keys("/dev/zero"), InputError);
}

TEST(CurveKeys, AreFreshEachTime) {
  EXPECT_NE(make_curve_keys().secret_key, make_curve_keys().secret_key);
}

}  // namespace
}  // namespace sightline
