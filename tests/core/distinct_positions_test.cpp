#include "core/distinct_positions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <tuple>

using namespace cloudbake;

// Positions on a small lattice, which repeat, and far more of them than expected, so that the table grows.
TEST(DistinctPositions, FindsWhatAMapFinds) {
  DistinctPositions distinct(3);
  std::map<std::tuple<float, float, float>, uint32_t> known;
  uint32_t state = 1;
  const auto next = [&] { return float((state = state * 1664525U + 1013904223U) >> 28) * 0.25F; };
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p{next(), next(), next()};
    const auto expected = known.try_emplace({p.x, p.y, p.z}, uint32_t(known.size())).first->second;
    ASSERT_EQ(distinct.add(p), expected);
    ASSERT_EQ(distinct.positions[expected], p);
  }
  EXPECT_EQ(distinct.positions.size(), known.size());
  EXPECT_GT(known.size(), 1000U);
}

TEST(DistinctPositions, KeepsTheFirstOfTwoZeros) {
  DistinctPositions distinct;
  EXPECT_EQ(distinct.add({-0.0F, 1, 2}), 0U);
  EXPECT_EQ(distinct.add({0.0F, 1, 2}), 0U);
  EXPECT_TRUE(std::signbit(distinct.positions[0].x));
}
