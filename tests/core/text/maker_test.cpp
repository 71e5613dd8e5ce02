#include "core/text/maker.h"

#include <gtest/gtest.h>

namespace cloudbake {
namespace {

TEST(Maker, IsNamedWithAVersion) {
  for (const char* text : {"// cloudbake 0.1.0: a shader", "\"generator\":\"cloudbake 12.34\"", "no cloudbake x, but cloudbake 1.0"})
    EXPECT_TRUE(namesMaker(text)) << text;
  for (const char* text : {"", "cloudbake", "cloudbake ", "cloudbake 1", "cloudbake 1.", "cloudbake v1.0", "cloudbake .1", "Cloudbake 1.0"})
    EXPECT_FALSE(namesMaker(text)) << text;
  EXPECT_TRUE(namesMaker(kMaker));
}

}  // namespace
}  // namespace cloudbake
