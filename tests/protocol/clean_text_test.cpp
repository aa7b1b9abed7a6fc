#include "protocol/clean_text.hpp"

#include <random>

#include <gtest/gtest.h>

namespace sightline {
namespace {

TEST(CleanText, AcceptsOrdinaryTextInAnyScript) {
  for (const char* text : {"", "item_buffer", "héllo", "日本語", "🚀 ~"}) {
    EXPECT_TRUE(is_clean_text(text)) << text;
    EXPECT_EQ(clean_text(text), text);
  }
}

TEST(CleanText, RefusesControlCharacters) {
  for (const char* text : {"a\nb", "\x1B[2J", "\x7F", "tab\t", "\xC2\x9B", "\xE2\x80\xA8"}) {
    EXPECT_FALSE(is_clean_text(text)) << text;
  }
  EXPECT_FALSE(is_clean_text(std::string_view("\0", 1)));
}

TEST(CleanText, RefusesWhatIsNoUtf8) {
  // Lone continuation, cut short, overlong "/" in two, three and four bytes, a surrogate, above U+10FFFF.
  for (const char* text : {"\x80", "\xC3", "\xE6\x97", "\xC0\xAF", "\xE0\x80\xAF", "\xF0\x80\x80\xAF",
                           "\xED\xA0\x80", "\xF4\x90\x80\x80", "\xFF"}) {
    EXPECT_FALSE(is_clean_text(text)) << text;
    EXPECT_TRUE(is_clean_text(clean_text(text)));
  }
}

TEST(CleanText, MakesAnythingCleanAndShortEnough) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 200; ++round) {
    std::string text(random() % 2000, '\0');
    for (char& c : text) c = static_cast<char>(random());
    const std::string clean = clean_text(text);
    EXPECT_TRUE(is_clean_text(clean));
    EXPECT_LE(clean.size(), k_max_text_bytes);
  }
}

TEST(CleanText, CutsBetweenCharacters) {
  std::string text(k_max_text_bytes - 1, 'x');
  EXPECT_EQ(clean_text(text + "é"), text);
}

}  // namespace
}  // namespace sightline
