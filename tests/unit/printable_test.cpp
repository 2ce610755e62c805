// Text of others, before a terminal sees it.
#include "core/base/printable.h"

#include <gtest/gtest.h>

#include <string>

namespace irsig {
namespace {

using namespace std::string_literals;

TEST(Printable, LeavesTextOfEveryLanguage) {
  for (const std::string& text :
       {""s, "frigate 2"s, "Größe"s, "護衛艦"s, "\U0001F6A2"s, "\xC2\xA0"s}) {
    EXPECT_EQ(one_line(text), text);
    EXPECT_EQ(printable(text), text);
    EXPECT_TRUE(is_one_line(text)) << text;
  }
}

TEST(Printable, TakesOutWhatATerminalObeys) {
  // A window's title, a cleared screen, a cursor moved back, DEL, CSI and OSC as C1.
  EXPECT_EQ(one_line("a\x1b]0;title\x07z"), "a?]0;title?z");
  EXPECT_EQ(one_line("\x1b[2J\b\r\n\t\x7f"), "?[2J?????");
  EXPECT_EQ(one_line("\xC2\x9b"s + "31m\xC2\x9d\xC2\x80"), "?31m??");
  EXPECT_EQ(one_line("a\0b"s), "a?b");
  EXPECT_EQ(printable("one\ttwo\n\x1b[31mred\r"), "one\ttwo\n?[31mred?");
}

TEST(Printable, TakesOutWhatIsNotUtf8) {
  EXPECT_EQ(one_line("\x9b\x33\x31m"), "?31m");  // CSI as one byte
  EXPECT_EQ(one_line("\xff\xfe"), "??");
  EXPECT_EQ(one_line("\xC0\x9b"), "??");  // ESC, overlong
  EXPECT_EQ(one_line("\xE0\x80\x9b"), "???");
  EXPECT_EQ(one_line("\xED\xA0\x80"), "???");       // a surrogate
  EXPECT_EQ(one_line("\xF4\x90\x80\x80"), "????");  // beyond Unicode
  EXPECT_EQ(one_line("x\xE8\xAD"), "x??");          // cut short
  EXPECT_EQ(one_line("\xE8\x1b[2J"), "??[2J");      // ESC within a character
  EXPECT_FALSE(is_one_line("\xE8"));
}

TEST(Printable, EveryByteAndPairOfBytesIsHarmlessAfterwards) {
  for (unsigned a = 0; a < 256; ++a) {
    for (unsigned b = 0; b < 256; ++b) {
      const std::string text = {static_cast<char>(a), static_cast<char>(b)};
      const std::string plain = one_line(text);
      EXPECT_TRUE(is_one_line(plain));
      for (const char c : plain) EXPECT_TRUE(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f);
      EXPECT_EQ(plain == text, is_one_line(text));
    }
  }
}

}  // namespace
}  // namespace irsig
