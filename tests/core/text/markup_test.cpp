// Texts that come from files, on their way to a terminal, a log or a page.
#include "core/text/markup.h"

#include <gtest/gtest.h>

namespace cloudbake {
namespace {

TEST(OnOneLine, ControlCharactersBecomeBlanks) {
  EXPECT_EQ(onOneLine("a\x1b]0;title\x07"
                      "b\r\n\tc\x7f"),
            "a ]0;title b   c ");
  EXPECT_EQ(onOwnLines("a\tb\n\x1b[0m\n\nc"), "a b\n [0m\n\nc");
  EXPECT_EQ(onOneLine("a\u0085\u009b31mb"), "a  31mb") << "C1";
  EXPECT_EQ(onOneLine("gpj.\u202Ecod\u2066x\u2069\u200F\u061C\u2028"), "gpj. cod x    ") << "bidirectional marks and separators";
}

TEST(OnOneLine, OtherTextStays) {
  for (const char* text : {"", "plain", "σ = 0.5 → 𝄞 é", "a b  c"}) EXPECT_EQ(onOneLine(text), text);
  EXPECT_EQ(onOneLine("a\xff\xfe"
                      "b"),
            "a\uFFFD\uFFFD"
            "b");
}

TEST(OnOneLine, LongTextsAreCutBetweenCharacters) {
  std::string longest;
  for (int i = 0; i < 999; ++i) longest += "é";
  EXPECT_EQ(onOneLine(longest + "ab"), longest + "ab");
  EXPECT_EQ(onOneLine(longest + "aé"), longest + "a…");
  const std::string cut = onOneLine(std::string(1 << 20, 'x'));
  EXPECT_EQ(cut, std::string(2000, 'x') + "…");
}

TEST(EscapedMarkup, HoldsNoMarkupAndNoControls) {
  EXPECT_EQ(escapedMarkup("<a href='x'>\"&\n\x01"), "&lt;a href=&#39;x&#39;&gt;&quot;&amp;&#10;");
}

TEST(FilledTemplate, WhatIsPutInIsNotLookedAtAgain) {
  EXPECT_EQ(filledTemplate("<@A@|@B@|@A@>", {{"@A@", "@B@"}, {"@B@", "@A@@B@"}}), "<@B@|@A@@B@|@B@>");
  EXPECT_EQ(filledTemplate("@@A@@ a@b @C@", {{"@A@", "x"}}), "@x@ a@b @C@") << "other signs stay";
  EXPECT_EQ(filledTemplate("a<b<", {{"<", "<<"}}), "a<<b<<");
  EXPECT_EQ(filledTemplate("", {{"<", "x"}}), "");
  EXPECT_EQ(filledTemplate("none", {{"@A@", "x"}}), "none");
}

}  // namespace
}  // namespace cloudbake
