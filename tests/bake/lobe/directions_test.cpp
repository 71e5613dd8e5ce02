#include "bake/lobe/directions.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/random.h"

using namespace cloudbake;

namespace {

std::vector<Vec3> draw(Sampler sampler, int count, uint64_t stream) {
  std::vector<Vec3> out(static_cast<size_t>(count));
  if (sampler == Sampler::kStratified) stratifiedDirections(stream, out);
  if (sampler == Sampler::kUniform) uniformDirections(stream, out);
  if (sampler == Sampler::kFibonacci) rotatedDirections(fibonacciDirections(count), stream, out);
  return out;
}

class EverySampler : public testing::TestWithParam<std::tuple<Sampler, int>> {};

}  // namespace

// E[Σω]/N = 0 and E[Σ ω ωᵀ]/N = I/3: the sampler integrates 1, ω and ω² without bias. Bounds: five standard errors of
// 20,000 sets of independent draws, which the other samplers undercut.
TEST_P(EverySampler, HasTheMomentsOfTheSphere) {
  const auto [sampler, count] = GetParam();
  const int sets = 20000;
  double mean[3] = {}, second[3][3] = {};
  for (int set = 0; set < sets; ++set)
    for (const Vec3& w : draw(sampler, count, mix64(uint64_t(set) + 1))) {
      ASSERT_NEAR(dot(w, w), 1, 1e-5);
      const float v[3] = {w.x, w.y, w.z};
      for (int r = 0; r < 3; ++r) {
        mean[r] += v[r];
        for (int c = 0; c < 3; ++c) second[r][c] += v[r] * v[c];
      }
    }
  const double n = double(sets) * count, error = 5 / std::sqrt(n);
  for (int r = 0; r < 3; ++r) {
    EXPECT_NEAR(mean[r] / n, 0, error * std::sqrt(1.0 / 3));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(second[r][c] / n, r == c ? 1.0 / 3 : 0, error * 0.3);
  }
}
INSTANTIATE_TEST_SUITE_P(, EverySampler,
                         testing::Combine(testing::Values(Sampler::kStratified, Sampler::kFibonacci, Sampler::kUniform),
                                          testing::Values(1, 2, 3, 7, 50, 100)));

// Every stratum holds exactly one direction: 10 × 10 cells of equal area for N = 100.
TEST(Directions, StratifiedFillsEveryCellOnce) {
  for (uint64_t stream = 1; stream < 50; ++stream) {
    std::vector<int> cells(100, 0);
    for (const Vec3& w : draw(Sampler::kStratified, 100, mix64(stream))) {
      const int band = std::min(9, int((1 - w.z) * 5));
      const double turns = std::atan2(w.y, w.x) / (2 * kPi);
      ++cells[size_t(band) * 10 + size_t(std::min(9, int((turns < 0 ? turns + 1 : turns) * 10)))];
    }
    EXPECT_EQ(std::count(cells.begin(), cells.end(), 1), 100);
  }
}

// The Fibonacci set's covariance is I/3 to O(1/N): far better than 100 random directions (0.03).
TEST(Directions, FibonacciSetIsBalanced) {
  double z2 = 0;
  Vec3 sum{};
  const auto set = fibonacciDirections(100);
  for (const Vec3& w : set) z2 += double(w.z) * w.z, sum += w;
  EXPECT_NEAR(z2 / 100, 1.0 / 3, 1e-4);
  EXPECT_LT(length(sum) / 100, 2e-3);
}

// Every index once, and eight that follow each other lie in a small cap.
TEST(Directions, CoherentOrderKeepsNeighboursTogether) {
  const std::vector<Vec3> directions = fibonacciDirections(4096);
  std::vector<size_t> order = coherentOrder(directions);
  double sum = 0;
  for (size_t i = 1; i < order.size(); ++i) sum += angleDegrees(directions[order[i - 1]], directions[order[i]]);
  EXPECT_LT(sum / double(order.size()), 6) << "the set's spacing is 3 degrees";
  std::sort(order.begin(), order.end());
  for (size_t i = 0; i < order.size(); ++i) ASSERT_EQ(order[i], i);
}

TEST(Directions, StreamsDiffer) {
  for (const Sampler sampler : {Sampler::kStratified, Sampler::kFibonacci, Sampler::kUniform}) {
    EXPECT_NE(draw(sampler, 4, 1), draw(sampler, 4, 2));
    EXPECT_EQ(draw(sampler, 4, 1), draw(sampler, 4, 1));
  }
}
