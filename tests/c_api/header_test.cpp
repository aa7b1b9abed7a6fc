// The header is one for C, and the library says what it is.

#include <set>
#include <string>

#include "tests/c_api/c_program.hpp"
#include "tests/c_api/header_in_c99.h"

namespace sightline::testing {
namespace {

TEST(CHeader, ServesAC99Program) {
  EXPECT_TRUE(c99_version_is_served());
  EXPECT_EQ(c99_connects_without_a_daemon(), 0) << sl_last_error(nullptr);
}

TEST(CHeader, HasATextOfItsOwnForEveryStatus) {
  std::set<std::string> texts;
  for (sl_status status = SL_ERROR_INTERNAL; status <= SL_TIMEOUT; ++status) {
    ASSERT_NE(sl_status_text(status), nullptr);
    texts.insert(sl_status_text(status));
  }
  EXPECT_EQ(texts.size(), 17u);
  EXPECT_EQ(texts.count(sl_status_text(-1000)), 0u);
  EXPECT_EQ(std::string(sl_status_text(1000)), sl_status_text(-1000));
  EXPECT_EQ(std::string(sl_version_text()).rfind("1.", 0), 0u);
}

TEST(CHeader, LeavesNoGapsWhereLaterFieldsWouldBeUnset) {
  // Sizes are part of the interface: a change of one is a change of version.
  EXPECT_EQ(sizeof(sl_material), 40u);
  EXPECT_EQ(sizeof(sl_mesh), 80u);
  EXPECT_EQ(sizeof(sl_object), 144u);
  EXPECT_EQ(sizeof(sl_boxed_object), 192u);
  EXPECT_EQ(sizeof(sl_options), 112u);
  EXPECT_EQ(sizeof(sl_view), 280u);
  EXPECT_EQ(sizeof(sl_frame), 24u);
  EXPECT_EQ(sizeof(sl_part), 12u);
  EXPECT_EQ(sizeof(sl_box), 48u);
}

}  // namespace
}  // namespace sightline::testing
