#include "core/text/plain_text.h"

#include <gtest/gtest.h>

#include "core/error.h"

using namespace cloudbake;

namespace {

std::string mended(std::string_view bytes) {
  std::string storage;
  return std::string(plainText(bytes, "a.txt", storage));
}

bool isRefused(std::string_view bytes) {
  try {
    mended(bytes);
    return false;
  } catch (const InputError& error) {
    return std::string(error.what()).find("UTF-16") != std::string::npos;
  }
}

}  // namespace

TEST(PlainText, EndsLinesAlike) {
  EXPECT_EQ(mended("a\rb\r\nc\n\rd\r"), "a\nb\r\nc\n\nd\n");
  EXPECT_EQ(mended("\xEF\xBB\xBF"
                   "a\rb"),
            "a\nb");
  EXPECT_EQ(mended("\xEF\xBB\xBF"), "");
  EXPECT_EQ(mended(""), "");
}

TEST(PlainText, CopiesOnlyWhatItChanges) {
  const std::string text =
      "\xEF\xBB\xBF"
      "a\r\nb\n";
  std::string storage;
  EXPECT_EQ(plainText(text, "a.txt", storage).data(), text.data() + 3);
  EXPECT_TRUE(storage.empty());
}

TEST(PlainText, RefusesWideTextByName) {
  using namespace std::string_view_literals;
  EXPECT_TRUE(
      isRefused("\xFF\xFE"
                "v\0"sv));
  EXPECT_TRUE(isRefused("\xFE\xFF\0v"sv));
  EXPECT_TRUE(isRefused("v\0 \0"sv));
  EXPECT_TRUE(isRefused("\0v\0 "sv));
  EXPECT_TRUE(isRefused("\xFF\xFE\0\0v\0\0\0"sv));
  EXPECT_TRUE(isRefused("\0\0\xFE\xFF"sv));
  EXPECT_FALSE(isRefused("v 1 2 3"));
  EXPECT_FALSE(isRefused("v\0"sv)) << "too short to tell";
}
