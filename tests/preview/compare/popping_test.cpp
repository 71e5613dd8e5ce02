// The change of a picture by a level of detail, and the size up to which it is small enough.
#include "preview/compare/popping.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/shapes.h"

namespace cloudbake {
namespace {

TEST(Popping, TheSameMeshChangesNothing) {
  const BakedMesh ball = bakedBall(1, {}, 3);
  const auto changes = popping(ball, {&ball, 1});
  ASSERT_EQ(changes.size(), 1U);
  ASSERT_GE(changes[0].size(), 5U);
  for (const SizeChange& change : changes[0]) EXPECT_EQ(change.rms, 0) << change.pixels;
  EXPECT_EQ(switchPixels(changes[0]), kLargestSwitch);
}

TEST(Popping, GrowsWithTheSizeAndTheCoarsenessAtAnyScaleAndPlace) {
  const BakedMesh full = bakedBall(1, {}, 5);
  const BakedMesh levels[] = {bakedBall(1, {}, 3), bakedBall(1, {}, 2)};
  const auto changes = popping(full, levels);
  for (size_t i = 0; i + 1 < changes[0].size(); ++i) {
    EXPECT_EQ(changes[0][i].pixels, 2 * changes[0][i + 1].pixels);
    EXPECT_GT(changes[0][i].rms, changes[0][i + 1].rms);
    EXPECT_GT(changes[1][i].rms, 1.5 * changes[0][i].rms);
  }
  EXPECT_LT(switchPixels(changes[1]), switchPixels(changes[0]));
  const BakedMesh far = bakedBall(1e3F, {5e3F, 0, 0}, 5), far_levels[] = {bakedBall(1e3F, {5e3F, 0, 0}, 3)};
  const auto again = popping(far, far_levels);
  for (size_t i = 0; i < again[0].size(); ++i) EXPECT_NEAR(again[0][i].rms / changes[0][i].rms, 1, 0.05) << i;
}

// A level that is darker by a known part of the light: the cloud's tone is all that changes, at every size alike.
TEST(Popping, CountsTheCloudsPixelsAlone) {
  BakedMesh full = bakedBall(1, {}, 3), other = full;
  for (Lobe& lobe : full.lobes) lobe.thickness = 0;
  for (Lobe& lobe : other.lobes) lobe.thickness = 1e9F;
  const auto changes = popping(full, {&other, 1});
  EXPECT_GT(changes[0].front().rms, 20);
  EXPECT_NEAR(changes[0].back().rms / changes[0].front().rms, 1, 0.25);
}

TEST(Popping, HasTheSameBitsForAnyNumberOfThreads) {
  const BakedMesh full = bakedBall(1, {}, 4), level = bakedBall(1, {}, 2);
  const auto many = popping(full, {&level, 1});
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto few = popping(full, {&level, 1});
  for (size_t i = 0; i < many[0].size(); ++i) EXPECT_EQ(many[0][i].rms, few[0][i].rms);
}

TEST(SwitchPixels, LieBetweenTheSizesAroundTheBound) {
  const SizeChange changes[] = {{1024, 8}, {512, 4}, {256, 2}, {128, 1}};
  EXPECT_EQ(switchPixels(changes, 2), 250);  // rounded down
  EXPECT_EQ(switchPixels(changes, 2.1F), 260);
  EXPECT_EQ(switchPixels(changes, 4), 510);
  EXPECT_EQ(switchPixels(changes, 1), 120);
  EXPECT_EQ(switchPixels(changes, 0.9F), 0);
  EXPECT_EQ(switchPixels(changes, 8), kLargestSwitch);
  EXPECT_EQ(switchPixels({}, 8), 0);
  const SizeChange uneven[] = {{512, 1}, {256, 4}, {128, 1}};
  EXPECT_EQ(switchPixels(uneven, 2), 180) << "smaller sizes decide: no size below may be over the bound";
  const SizeChange from_none[] = {{64, 3}, {32, 0}};
  EXPECT_EQ(switchPixels(from_none, 2), 32);
}

}  // namespace
}  // namespace cloudbake
