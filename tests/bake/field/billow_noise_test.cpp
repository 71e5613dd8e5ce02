#include "bake/field/billow_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

#include "core/random.h"

using namespace cloudbake;

namespace {

// Uniform in a cube [low, high)³.
Vec3 randomPoint(uint32_t n, float low, float high) {
  const auto coordinate = [&](uint32_t axis) { return low + (high - low) * uniformFloat(hashDraw(7, n, axis)); };
  return {coordinate(0), coordinate(1), coordinate(2)};
}

constexpr int kReach = 3;  // cells that are searched for feature points: −3 … 2 per axis

// Feature points of one octave, found by following the gradient from a dense lattice: p = x + ∇b/2.
std::vector<Vec3> featurePoints(uint64_t seed) {
  std::map<std::array<int, 3>, Vec3> found;  // by place, in thousandths
  const int steps = 2 * kReach * 20;
  for (int i = 0; i < steps * steps * steps; ++i) {
    const Vec3 x = Vec3{float(i % steps), float(i / steps % steps), float(i / steps / steps)} / 20 - Vec3{kReach, kReach, kReach};
    const Vec3 p = x + billow(x, 1, seed).gradient / 2;
    if (p == x) continue;
    found[{int(std::lround(p.x * 1000)), int(std::lround(p.y * 1000)), int(std::lround(p.z * 1000))}] = p;
  }
  std::vector<Vec3> points;  // without the doubles that rounding made
  for (const auto& [place, p] : found)
    if (std::none_of(points.begin(), points.end(), [p = p](Vec3 q) { return length(p - q) < 1e-3F; })) points.push_back(p);
  return points;
}

std::array<int, 3> cellOf(Vec3 p) { return {int(std::floor(p.x)), int(std::floor(p.y)), int(std::floor(p.z))}; }

}  // namespace

// One point per cell, on both sides of 0, at which the noise is 1; and it is 1 − F1² by a search of all of them.
TEST(BillowNoise, IsTheDistanceToOnePointPerCell) {
  const std::vector<Vec3> points = featurePoints(1);
  std::map<std::array<int, 3>, int> per_cell;
  for (const Vec3 p : points) {
    ++per_cell[cellOf(p)];
    EXPECT_NEAR(billow(p, 1, 1).value, 1, 1e-5);
  }
  for (int i = 0; i < 8 * kReach * kReach * kReach; ++i) {
    const int side = 2 * kReach;
    EXPECT_EQ((per_cell[{i % side - kReach, i / side % side - kReach, i / side / side - kReach}]), 1) << i;
  }
  for (uint32_t n = 0; n < 20000; ++n) {
    const Vec3 x = randomPoint(n, -2, 2);
    float nearest = 1;
    for (const Vec3 p : points) nearest = std::min(nearest, dot(x - p, x - p));
    ASSERT_NEAR(billow(x, 1, 1).value, 1 - nearest, 1e-5);
  }
}

// Places in the cell: each axis uniform, no axis tied to another.
TEST(BillowNoise, PointsAreUniformInTheirCells) {
  std::vector<Vec3> places;
  for (uint64_t seed = 1; seed <= 8; ++seed)
    for (const Vec3 p : featurePoints(seed)) places.push_back({p.x - std::floor(p.x), p.y - std::floor(p.y), p.z - std::floor(p.z)});
  Vec3 mean, square, mixed;
  for (const Vec3 p : places) {
    const Vec3 q = p - Vec3{0.5F, 0.5F, 0.5F};
    mean += q / float(places.size());
    square += Vec3{q.x * q.x, q.y * q.y, q.z * q.z} / float(places.size());
    mixed += Vec3{q.x * q.y, q.y * q.z, q.z * q.x} / float(places.size());
  }
  for (const float m : {mean.x, mean.y, mean.z}) EXPECT_NEAR(m, 0, 0.03);
  for (const float s : {square.x, square.y, square.z}) EXPECT_NEAR(s, 1 / 12.0, 0.01);
  for (const float m : {mixed.x, mixed.y, mixed.z}) EXPECT_NEAR(m, 0, 0.01);
}

// The range is used, and never left, wherever x is; the slope comes near its bound for one octave and never reaches it.
TEST(BillowNoise, KeepsItsBounds) {
  for (const int octaves : {1, 3, 8})
    for (const float reach : {8.0F, 1e5F, 1e15F}) {
      float low = 1, high = 0, steepest = 0;
      for (uint32_t n = 0; n < 100000; ++n) {
        const auto [value, gradient] = billow(randomPoint(n, -reach, reach), octaves, 1);
        low = std::min(low, value), high = std::max(high, value);
        steepest = std::max(steepest, length(gradient));
      }
      EXPECT_GE(low, 0);
      EXPECT_LE(high, 1);
      EXPECT_LT(steepest, billowSlope(octaves));
      if (reach > 1e6F) continue;
      EXPECT_LT(low, 0.2F);
      EXPECT_GT(high, 0.85F);
      EXPECT_GT(steepest, octaves == 1 ? 1.95 : 0.5 * billowSlope(octaves));
    }
  EXPECT_DOUBLE_EQ(billowSlope(1), 2);
  EXPECT_DOUBLE_EQ(billowSlope(3), 3 * 2 / 1.75);
}

// Against central differences, where neither side of the difference lies beyond a crease.
TEST(BillowNoise, GradientIsTheDerivative) {
  const float h = 1e-3F;
  for (const int octaves : {1, 3}) {
    const float curvature = 2 * float((1 << octaves) - 1) / (2 - std::ldexp(1.0F, 1 - octaves));
    int smooth = 0;
    for (uint32_t n = 0; n < 100000; ++n) {
      const Vec3 x = randomPoint(n, -4, 4);
      const int axis = int(n % 3);
      const Vec3 step{axis == 0 ? h : 0, axis == 1 ? h : 0, axis == 2 ? h : 0};
      const NoiseSample before = billow(x - step, octaves, 3), at = billow(x, octaves, 3), after = billow(x + step, octaves, 3);
      if (length(after.gradient - before.gradient) > 2.1F * curvature * h) continue;
      ++smooth;
      ASSERT_NEAR((after.value - before.value) / (2 * h), dot(at.gradient, step) / h, 0.01) << octaves;
    }
    EXPECT_GT(smooth, 95000) << octaves;
  }
}

// No step at the borders of the cells of any octave, nor between any two points.
TEST(BillowNoise, IsContinuous) {
  for (const int octaves : {1, 4})
    for (uint32_t n = 0; n < 100000; ++n) {
      Vec3 x = randomPoint(n, -4, 4);
      x.x = std::floor(x.x * 8) / 8;
      if (n % 2) std::swap(x.x, x.y);
      if (n % 3) std::swap(x.y, x.z);
      const Vec3 step = randomPoint(n + 100000, -1e-3F, 1e-3F);
      ASSERT_LE(std::fabs(billow(x + step, octaves, 1).value - billow(x - step, octaves, 1).value),
                2 * length(step) * billowSlope(octaves) + 1e-6);
    }
}

// The second octave has half the height and half the spacing of the first, and bumps of its own.
TEST(BillowNoise, OctavesHalve) {
  double coarse = 0, fine = 0;
  int alike = 0;
  const int count = 20000;
  for (uint32_t n = 0; n < count; ++n) {
    const Vec3 x = randomPoint(n, -50, 50);
    const NoiseSample one = billow(x, 1, 1), two = billow(x, 2, 1);
    const float second = 2 * (1.5F * two.value - one.value);  // Σ 2⁻ᵏ = 1.5
    ASSERT_GE(second, -1e-5F);
    ASSERT_LE(second, 1 + 1e-5F);
    coarse += length(one.gradient);
    fine += length(2 * (1.5F * two.gradient - one.gradient));
    alike += std::fabs(second - billow(2 * x, 1, 1).value) < 1e-3F;
  }
  EXPECT_NEAR(fine / coarse, 2, 0.05);
  EXPECT_LT(alike, count / 10);
}

TEST(BillowNoise, SeedsDiffer) {
  int alike = 0;
  for (uint32_t n = 0; n < 10000; ++n) {
    const Vec3 x = randomPoint(n, -50, 50);
    alike += std::fabs(billow(x, 1, 1).value - billow(x, 1, 2).value) < 1e-3F;
  }
  EXPECT_LT(alike, 1000);
}
