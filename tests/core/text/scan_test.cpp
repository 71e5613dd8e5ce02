#include "core/text/scan.h"

#include <gtest/gtest.h>

using cloudbake::parseInteger;
using cloudbake::parseNumber;
using cloudbake::quotedWord;
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

TEST(Scan, ANumberHasOneSign) {
  EXPECT_EQ(parseInteger("+3"), 3);
  EXPECT_EQ(parseInteger("-3"), -3);
  EXPECT_EQ(parseNumber("+.5"), 0.5);
  for (const char* word : {"+-3", "--3", "++3", "+", "", "3x", "99999999999999999999"}) EXPECT_FALSE(parseInteger(word)) << word;
  for (const char* word : {"+-3", "--3", "++3", "+", "", "3x"}) EXPECT_FALSE(parseNumber(word)) << word;
}

TEST(Scan, WordsForMessagesAreCut) {
  EXPECT_EQ(quotedWord("3x"), "'3x'");
  EXPECT_EQ(quotedWord(""), "''");
  EXPECT_EQ(quotedWord(std::string(40, '9')), "'" + std::string(40, '9') + "'");
  EXPECT_EQ(quotedWord(std::string(41, '9')), "'" + std::string(40, '9') + "…'");
}
