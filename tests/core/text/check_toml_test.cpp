#include "core/text/check_toml.h"

#include <gtest/gtest.h>

#include "core/error.h"

using namespace cloudbake;

namespace {

// The line of the refusal; 0 where there is none.
int refusedAt(const std::string& text) {
  try {
    checkTomlText(text, "a.toml");
    return 0;
  } catch (const InputError& error) {
    EXPECT_EQ(error.file, "a.toml");
    return error.line;
  }
}

}  // namespace

TEST(CheckToml, TextsAndCommentsMayHoldAnything) {
  EXPECT_EQ(refusedAt("name = 'Wölkchen' # ähnlich . . . . . . . . . .\n[a.b.c]\nx = [1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5, 8.5, 9.5]\n"), 0);
  EXPECT_EQ(refusedAt("a = '''\n. . . . . . . . . . ü\n'''\nb = \"\\\". . . . . . . . . . ü\"\n"), 0);
}

TEST(CheckToml, LongKeysAndForeignLetters) {
  EXPECT_EQ(refusedAt("a = 1\na.b.c.d.e.f.g.h.i = 1\n"), 2);
  EXPECT_EQ(refusedAt("a = 1\n[" + std::string(50000, '.') + "]\n"), 2);
  EXPECT_EQ(refusedAt("\n\nä = 1\n"), 3);
  EXPECT_EQ(refusedAt("a = “text”\n"), 1);
  EXPECT_EQ(refusedAt("a = 'x'\nb = \"y\"\n\nc = ü"), 4);
}
