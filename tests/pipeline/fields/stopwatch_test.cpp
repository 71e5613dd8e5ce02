#include "pipeline/fields/stopwatch.h"

#include <gtest/gtest.h>

namespace cloudbake {
namespace {

TEST(Stopwatch, SumsPerNameInTheOrderOfTheFirst) {
  StageSeconds sums;
  addSeconds(sums, "read", 1);
  addSeconds(sums, "bake", 2);
  addSeconds(sums, "read", 4);
  EXPECT_EQ(sums, (StageSeconds{{"read", 5}, {"bake", 2}}));
}

// Laps are the time between them: together what has passed, and none counts twice.
TEST(Stopwatch, LapsShareWhatHasPassed) {
  StageSeconds seconds;
  std::vector<std::string> ended;
  Stopwatch watch([&](const std::string& stage) { ended.push_back(stage); });
  const double before = watch.elapsed();
  watch.lap(seconds, "a");
  watch.lap(seconds, "b");
  watch.lap(seconds, "a");
  const double after = watch.elapsed();
  EXPECT_EQ(ended, (std::vector<std::string>{"a", "b", "a"}));
  ASSERT_EQ(seconds.size(), 2U);
  EXPECT_EQ(seconds[0].first + seconds[1].first, "ab");
  EXPECT_GE(seconds[0].second, before);
  EXPECT_GE(seconds[1].second, 0);
  const double sum = seconds[0].second + seconds[1].second;
  EXPECT_LE(sum, after);
  EXPECT_GE(sum, before);
}

}  // namespace
}  // namespace cloudbake
