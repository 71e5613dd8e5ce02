// The choice of ways, against all plans that there are, and its limits.
#include "pipeline/plan/choose.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cloudbake {
namespace {

constexpr double kPixels = 1e6;

DrawnWay way(size_t vertices, uint64_t bytes, float change) {
  if (change == 0) return {vertices, bytes, {}, false};
  std::vector<SizeChange> changes;  // that grow with the root of the size
  for (float pixels = 1024; pixels >= 16; pixels /= 2) changes.push_back({pixels, change * std::sqrt(pixels / 1024)});
  return {vertices, bytes, changes, false};
}

std::vector<std::vector<DrawnWay>> twoAssets() {
  return {{way(10000, 280000, 0), way(5000, 140000, 2), way(1000, 30000, 6), way(4, 200000, 20)},
          {way(8000, 200000, 0), way(2000, 60000, 3), way(400, 12000, 9)}};
}

// Clouds of both assets at these sizes.
ViewCounts viewOf(const std::vector<float>& first, const std::vector<float>& second) {
  ViewCounts counts(2, SizeCounts{});
  for (const float pixels : first) ++counts[0][stepOfSize(pixels)];
  for (const float pixels : second) ++counts[1][stepOfSize(pixels)];
  return counts;
}

const std::vector<ViewCounts> kViews{viewOf({600, 200, 90, 40, 20}, {300, 80, 30, 15}), viewOf({120, 60}, {900, 70, 12})};

// The change and the vertices of a view in which clouds are drawn as `wayOf` says.
template <class WayOf>
std::pair<double, double> judged(const std::vector<std::vector<DrawnWay>>& assets, const ViewCounts& view, const WayOf& wayOf) {
  double squares = 0, area = 0, vertices = 0;
  for (size_t asset = 0; asset < assets.size(); ++asset)
    for (size_t step = 0; step < kSizeSteps; ++step) {
      const double covered = std::min(kPixels, 0.5 * std::pow(sizeOfStep(step), 2)) * view[asset][step];
      if (view[asset][step] == 0) continue;
      const DrawnWay& drawn = assets[asset][wayOf(asset, step)];
      squares += covered * std::pow(changeAt(drawn.changes, sizeOfStep(step)), 2);
      area += covered;
      vertices += double(view[asset][step]) * double(drawn.vertices);
    }
  return {std::sqrt(squares / area), vertices};
}

TEST(PlanSizes, StepsAreThoseOfTheirSizes) {
  EXPECT_EQ(sizeOfStep(0), 8);
  EXPECT_EQ(sizeOfStep(4), 16);
  EXPECT_TRUE(std::isinf(sizeOfStep(kSizeSteps - 1)));
  EXPECT_GT(sizeOfStep(kSizeSteps - 2), float(kLargestSwitch));
  for (size_t step = 0; step < kSizeSteps; ++step) EXPECT_EQ(stepOfSize(sizeOfStep(step)), step);
  EXPECT_EQ(stepOfSize(1), 0U);
  EXPECT_EQ(stepOfSize(16.5F), 5U);
}

TEST(PlanSizes, TheCoarsestWayWhoseSizeIsLargeEnoughIsDrawn) {
  const std::vector<int> sizes{0, 4000, 0, 100, 20};  // the full asset and the third way are never drawn
  EXPECT_EQ(wayAt(sizes, 1e9F), 1U);
  EXPECT_EQ(wayAt(sizes, 101), 1U);
  EXPECT_EQ(wayAt(sizes, 100), 3U);
  EXPECT_EQ(wayAt(sizes, 20), 4U);
}

TEST(ChooseWays, KeepsTheChangeInEachPictureAndSaysWhatItIs) {
  const auto assets = twoAssets();
  for (const double change : {0.5, 2.0, 5.0}) {
    const PlannedWays plan = chooseWays(assets, kViews, {change, {}, {}, {}}, kPixels);
    double worst = 0, vertices = 0;
    for (size_t view = 0; view < kViews.size(); ++view) {
      const auto [found, cost] =
          judged(assets, kViews[view], [&](size_t asset, size_t step) { return wayAt(plan.switch_pixels[asset], sizeOfStep(step)); });
      EXPECT_NEAR(found, plan.changes[view], 1e-9);
      worst = std::max(worst, found), vertices = std::max(vertices, cost);
    }
    EXPECT_LE(worst, change);
    EXPECT_NEAR(worst, plan.change, 1e-9);
    EXPECT_EQ(vertices, plan.cost.vertices);
  }
  EXPECT_EQ(chooseWays(assets, kViews, {0, {}, {}, {}}, kPixels).cost.vertices, costOfFull(assets, kViews).vertices);
}

TEST(ChooseWays, CostsLittleMoreThanTheBestOfAllPlans) {
  // One asset with two ways more, in one view: all pairs of sizes are tried.
  const std::vector<std::vector<DrawnWay>> assets{{way(10000, 1, 0), way(3000, 1, 3), way(500, 1, 8)}};
  ViewCounts view(1, SizeCounts{});
  for (const float pixels : {900.0F, 500.0F, 300.0F, 200.0F, 120.0F, 80.0F, 50.0F, 30.0F, 20.0F, 12.0F}) ++view[0][stepOfSize(pixels)];
  const std::vector<ViewCounts> views{view};
  for (const double change : {0.7, 1.5, 3.0}) {
    double best = 1e30;
    for (size_t first = 0; first < kSizeSteps; ++first)
      for (size_t second = 0; second <= first; ++second) {
        const auto [found, vertices] = judged(assets, view, [&](size_t, size_t step) {
          return step < second ? 2U : step < first ? 1U : 0U;
        });
        if (found <= change) best = std::min(best, vertices);
      }
    const PlannedWays plan = chooseWays(assets, views, {change, {}, {}, {}}, kPixels);
    EXPECT_LE(plan.change, change);
    EXPECT_LE(plan.cost.vertices, 1.25 * best) << change << ", the best is " << best;
  }
}

TEST(ChooseWays, LimitsOfCostCountMoreThanOtherCosts) {
  const auto assets = twoAssets();
  const PlannedWays free = chooseWays(assets, kViews, {3, {}, {}, {}}, kPixels);
  const PlannedWays few_bytes = chooseWays(assets, kViews, {3, {}, 0.9 * free.cost.bytes, {}}, kPixels);
  EXPECT_LE(few_bytes.cost.bytes, 0.9 * free.cost.bytes);
  EXPECT_GT(few_bytes.cost.vertices, free.cost.vertices);
  EXPECT_LE(few_bytes.change, 3);
  const PlannedWays few_draws = chooseWays(assets, kViews, {3, {}, {}, 2.0}, kPixels);
  EXPECT_EQ(few_draws.cost.draws, 2);
  EXPECT_LE(few_draws.change, 3);
}

TEST(ChooseWays, AnImpostorIsNeverAlone) {
  std::vector<std::vector<DrawnWay>> assets = twoAssets();
  for (std::vector<DrawnWay>& ways : assets) ways = {ways.front(), way(4, 1000, 5)};
  for (std::vector<DrawnWay>& ways : assets) ways.back().is_picture = true;
  const PlannedWays plan = chooseWays(assets, kViews, {255, {}, {}, {}}, kPixels);
  for (size_t asset = 0; asset < assets.size(); ++asset) {
    EXPECT_GT(plan.switch_pixels[asset][0], 0);
    EXPECT_GT(plan.switch_pixels[asset][1], 0);
  }
  EXPECT_EQ(plan.cost.bytes, 280000 + 200000 + 2 * 1000) << "the mesh's file is needed although it is not drawn";
}

TEST(ChooseWays, ACorrectionScalesTheChanges) {
  const auto assets = twoAssets();
  const PlannedWays once = chooseWays(assets, kViews, {2, {}, {}, {}}, kPixels, 1),
                    half = chooseWays(assets, kViews, {2, {}, {}, {}}, kPixels, 0.5),
                    other = chooseWays(assets, kViews, {4, {}, {}, {}}, kPixels, 1);
  EXPECT_LT(half.cost.vertices, once.cost.vertices);
  EXPECT_EQ(half.switch_pixels, other.switch_pixels);
}

}  // namespace
}  // namespace cloudbake
