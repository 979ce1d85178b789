#include "lib/core/visible_text.h"

#include <gtest/gtest.h>

#include <string>

namespace spool {
namespace {

TEST(VisibleText, EscapesWhatATerminalObeysAndKeepsWhatPeopleRead) {
  EXPECT_EQ(visible_text("plain, gr\u00f6\u00dfe, \u5370, \U0001F600"),
            "plain, gr\u00f6\u00dfe, \u5370, \U0001F600");
  EXPECT_EQ(visible_text("a\nb\tc\rd"), "a\\nb\\tc\\rd");
  EXPECT_EQ(visible_text("a\nb", true), "a\nb");
  EXPECT_EQ(visible_text("\x1b[2J\x07\x7f", true), "\\u001b[2J\\u0007\\u007f");
  EXPECT_EQ(visible_text("\u009b1m \u202e \u2028 \ufeff"), "\\u009b1m \\u202e \\u2028 \\ufeff");
}

TEST(VisibleText, ShowsBytesThatAreNoCharacters) {
  EXPECT_EQ(visible_text("x\xff\xfe.spool"), "x\\xff\\xfe.spool");
  EXPECT_EQ(visible_text("\xc0\x80 \xed\xa0\x80 \xf4\x90\x80\x80 \xe2\x82"),
            "\\xc0\\x80 \\xed\\xa0\\x80 \\xf4\\x90\\x80\\x80 \\xe2\\x82");
}

TEST(VisibleText, AsAsciiHasAMarkForEveryOtherByte) {
  EXPECT_EQ(printable_ascii("a ~\t\x7f\u00f6"), "a ~" + std::string(4, '?'));
}

// Every text of three bytes out of those where the rules change.
TEST(VisibleText, IsAlwaysOneLineOfUtf8WithoutControls) {
  const std::string bytes = std::string(
      "\x00\x09\x0a\x1b\x20\x41\x7e\x7f\x80\x9b\x9f\xa0\xbf\xc1\xc2\xdf\xe0\xe2\xed\xef\xf0"
      "\xf4\xf5\xff",
      24);
  for (const char a : bytes) {
    for (const char b : bytes) {
      for (const char c : bytes) {
        const std::string shown = visible_text(std::string{a, b, c});
        ASSERT_TRUE(is_utf8(shown));
        for (const char s : shown)
          ASSERT_TRUE(static_cast<unsigned char>(s) >= 0x20 && s != 0x7f);
        ASSERT_EQ(visible_text(shown), shown);
      }
    }
  }
}

}  // namespace
}  // namespace spool
