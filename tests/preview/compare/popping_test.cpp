// The change of a picture by a level of detail, and the size up to which it is small enough.
#include "preview/compare/popping.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/shapes.h"

namespace cloudbake {
namespace {

std::vector<std::vector<SizeChange>> popping(const BakedMesh& full, std::span<const BakedMesh> levels) {
  const Popping of_full(full);
  std::vector<std::vector<SizeChange>> changes;
  for (const BakedMesh& level : levels) changes.push_back(of_full.changesBy(level));
  return changes;
}

TEST(Popping, TheSameMeshChangesNothing) {
  const BakedMesh ball = bakedBall(1, {}, 3);
  const auto changes = popping(ball, {&ball, 1});
  ASSERT_EQ(changes.size(), 1U);
  ASSERT_GE(changes[0].size(), 5U);
  for (const SizeChange& change : changes[0]) EXPECT_EQ(change.rms, 0) << change.pixels;
  EXPECT_EQ(switchPixels(changes[0]), kLargestSwitch);
}

TEST(Popping, BetweenSizesTheChangeIsAPowerOfTheSize) {
  const std::vector<SizeChange> changes{{100, 8}, {25, 2}};
  EXPECT_EQ(changeAt({}, 50), 0);
  EXPECT_EQ(changeAt(changes, 1000), 8);
  EXPECT_EQ(changeAt(changes, 100), 8);
  EXPECT_NEAR(changeAt(changes, 50), 4, 1e-5F);
  EXPECT_EQ(changeAt(changes, 10), 2);
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

// Two balls far apart, among more sky, change like one ball of their size in pixels.
TEST(Popping, CountsTheCloudsPixelsAlone) {
  const auto pair = [](int subdivisions) {
    BakedMesh both = bakedBall(1, {0, -7, 0}, subdivisions);
    const BakedMesh other = bakedBall(1, {0, 7, 0}, subdivisions);
    for (Triangle t : other.surface.triangles) {
      for (uint32_t& v : t) v += uint32_t(both.surface.positions.size());
      both.surface.triangles.push_back(t);
    }
    both.surface.positions.insert(both.surface.positions.end(), other.surface.positions.begin(), other.surface.positions.end());
    both.surface.normals.insert(both.surface.normals.end(), other.surface.normals.begin(), other.surface.normals.end());
    both.lobes.insert(both.lobes.end(), other.lobes.begin(), other.lobes.end());
    return both;
  };
  const BakedMesh level = bakedBall(1, {}, 2), levels = pair(2);
  const auto one = popping(bakedBall(1, {}, 4), {&level, 1}), two = popping(pair(4), {&levels, 1});
  for (size_t i = 0; i < 3; ++i) {  // 16 units across instead of 2, with fewer rays per pixel
    const float ratio = two[0][i].rms / one[0][i + 3].rms;
    EXPECT_GT(ratio, 0.9) << i;
    EXPECT_LT(ratio, 1.4) << i;
  }
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
