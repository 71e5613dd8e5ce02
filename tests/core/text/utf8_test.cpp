#include "core/text/utf8.h"

#include <gtest/gtest.h>

using cloudbake::asUtf8;
using cloudbake::codePoints;

TEST(Utf8, KeepsValidTextAndReadsOtherBytesAsLatin1) {
  for (const char* valid : {"", "cloud", "Wölkchen", "雲", "\U0001F325", "\u07FF\uFFFD", "\uD7FF\uE000"}) EXPECT_EQ(asUtf8(valid), valid);
  EXPECT_EQ(asUtf8("tr\xE6"), "træ");
  EXPECT_EQ(asUtf8("\x80\xFF"), "\u0080ÿ");
  EXPECT_EQ(asUtf8("\xC0\xAF"), "À¯") << "not the shortest form";
  EXPECT_EQ(asUtf8("\xED\xA0\x80"), "í\u00A0\u0080") << "a surrogate";
  EXPECT_EQ(asUtf8("a\xC3"), "aÃ") << "cut off";
  EXPECT_EQ(asUtf8("\xF5\x80\x80\x80"), "õ\u0080\u0080\u0080") << "beyond U+10FFFF";
}

TEST(Utf8, CountsCodePointsAndNotBytes) {
  EXPECT_EQ(codePoints(""), 0U);
  EXPECT_EQ(codePoints("ab"), 2U);
  EXPECT_EQ(codePoints("Wölkchen 雲 \U0001F325"), 12U);
}
