#include "core/text/scan.h"

#include <gtest/gtest.h>

using cloudbake::takeWord;
using cloudbake::trimmed;

TEST(Scan, TrimmedKeepsBlanksBetweenWords) {
  EXPECT_EQ(trimmed(" \tmatte white\r\n"), "matte white");
  EXPECT_EQ(trimmed("x"), "x");
  EXPECT_EQ(trimmed(" \t"), "");
  EXPECT_EQ(trimmed(""), "");
}

TEST(Scan, WordsAreTakenOneByOne) {
  std::string_view text = " v\t1.5 \r\n";
  EXPECT_EQ(takeWord(text), "v");
  EXPECT_EQ(takeWord(text), "1.5");
  EXPECT_EQ(takeWord(text), "");
  EXPECT_EQ(text, "");
}
