// Noise against its definition: range, continuity, derivatives, tiling, statistics.
#include "preview/backdrop/noise.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "core/random.h"

namespace cloudbake {
namespace {

// Points all over the lattice, many of them near its lines.
std::vector<Vec3> places(int count) {
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const auto draw = [i](uint32_t what) { return uniformFloat(hashDraw(7, uint32_t(i), what)) * 40 - 20; };
    points.push_back({draw(0), draw(1), draw(2)});
  }
  return points;
}

struct Kind2 {
  const char* name;
  Noise2 (*noise)(Vec2, int period, uint32_t seed);
  float low, high;
};
const Kind2 kKinds2[] = {
    {"value",
     [](Vec2 p, int period, uint32_t seed) {
       return valueNoise2(p, {seed, period});
     },
     0, 1},
    {"gradient",
     [](Vec2 p, int period, uint32_t seed) {
       return gradientNoise2(p, {seed, period});
     },
     -1, 1},
    {"fbm of value", [](Vec2 p, int period, uint32_t seed) { return fbmValue2(p, {.seed = seed, .period = period}); }, 0, 1},
    {"fbm of gradient", [](Vec2 p, int period, uint32_t seed) { return fbmGradient2(p, {.seed = seed, .period = period}); }, -1, 1},
};
struct Kind3 {
  const char* name;
  Noise3 (*noise)(Vec3, int period, uint32_t seed);
};
const Kind3 kKinds3[] = {
    {"value",
     [](Vec3 p, int period, uint32_t seed) {
       return valueNoise3(p, {seed, period});
     }},
    {"fbm of value", [](Vec3 p, int period, uint32_t seed) { return fbmValue3(p, {.seed = seed, .period = period}); }},
};

TEST(Noise, StaysInItsRangeAndFillsIt) {
  for (const Kind2& kind : kKinds2) {
    float low = 9, high = -9;
    for (const Vec3 p : places(100000)) {
      const float value = kind.noise({p.x, p.y}, 0, 0).value;
      low = std::min(low, value);
      high = std::max(high, value);
    }
    EXPECT_GE(low, kind.low) << kind.name;
    EXPECT_LE(high, kind.high) << kind.name;
    EXPECT_LT(low, kind.low + 0.25F * (kind.high - kind.low)) << kind.name;
    EXPECT_GT(high, kind.high - 0.25F * (kind.high - kind.low)) << kind.name;
  }
  for (const Kind3& kind : kKinds3)
    for (const Vec3 p : places(100000)) {
      const float value = kind.noise(p, 0, 0).value;
      ASSERT_TRUE(value >= 0 && value <= 1) << kind.name;
    }
}

// The mean of the value noise is 1/2, of the gradient noise 0; gradient noise vanishes at the lattice points.
TEST(Noise, MeanIsTheMiddleOfTheRange) {
  for (const Kind2& kind : kKinds2) {
    double sum = 0;
    for (const Vec3 p : places(100000)) sum += kind.noise({p.x * 50, p.y * 50}, 0, 3).value;
    EXPECT_NEAR(sum / 100000, (kind.low + kind.high) / 2, 0.01) << kind.name;
  }
  for (int i = -5; i < 5; ++i) EXPECT_EQ(gradientNoise2({float(i), float(3 * i)}).value, 0);
}

// Neighbours are independent: what one lattice point holds tells nothing of the next.
// At the lattice points the gradient is the unit vector of the point: of 20,000, an eighth lies in each octant of the circle (σ = 47).
TEST(Noise, GradientsPointEverywhereAlike) {
  std::array<int, 8> counts{};
  for (int i = 0; i < 200; ++i)
    for (int j = 0; j < 100; ++j) {
      const Vec2 g = gradientNoise2({float(i), float(j)}).gradient;
      ++counts[size_t(g.x < 0) + 2 * size_t(g.y < 0) + 4 * size_t(std::abs(g.x) < std::abs(g.y))];
    }
  for (const int count : counts) EXPECT_NEAR(count, 2500, 250);
}

TEST(Noise, LatticePointsAreUncorrelated) {
  double along_x = 0, along_y = 0, along_z = 0;
  constexpr int kCount = 40;
  for (int i = 0; i < kCount; ++i)
    for (int j = 0; j < kCount; ++j)
      for (int k = 0; k < kCount; ++k) {
        const auto at = [](int x, int y, int z) { return double(valueNoise3({float(x), float(y), float(z)}).value) - 0.5; };
        along_x += at(i, j, k) * at(i + 1, j, k);
        along_y += at(i, j, k) * at(i, j + 1, k);
        along_z += at(i, j, k) * at(i, j, k + 1);
      }
  // A product has the deviation 1/12; four of its standard errors.
  for (const double sum : {along_x, along_y, along_z}) EXPECT_LT(std::abs(sum / 64000), 4.0 / 12 / std::sqrt(64000.0));
}

// Also where a tile meets the next one: with a period of 3 lines −3, 0 and 3 are such.
TEST(Noise, ValueAndGradientAreContinuousAcrossLatticeLines) {
  constexpr float kStep = 1e-4F;
  for (const Kind2& kind : kKinds2)
    for (const int period : {0, 3})
      for (int line = -3; line <= 3; ++line)
        for (float along = -2.05F; along < 2; along += 0.31F)
          for (const bool across_x : {true, false}) {
            const auto at = [&](float offset) {
              const float across = float(line) + offset;
              return kind.noise(across_x ? Vec2{across, along} : Vec2{along, across}, period, 0);
            };
            const Noise2 before = at(-kStep), after = at(kStep);
            ASSERT_NEAR(before.value, after.value, 20 * kStep) << kind.name;
            ASSERT_NEAR(before.gradient.x, after.gradient.x, 0.05F) << kind.name;
            ASSERT_NEAR(before.gradient.y, after.gradient.y, 0.05F) << kind.name;
          }
  for (const int period : {0, 3})
    for (int line = -3; line <= 3; ++line)
      for (const Vec3 axis : {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
        const Vec3 place = Vec3{0.3F, 0.7F, 0.4F} + axis * (float(line) - dot(axis, {0.3F, 0.7F, 0.4F}));
        const Noise3 before = valueNoise3(place - axis * kStep, {0, period}), after = valueNoise3(place + axis * kStep, {0, period});
        ASSERT_NEAR(before.value, after.value, 1e-3F);
        ASSERT_LT(length(before.gradient - after.gradient), 2e-2F);
      }
}

// The second octave has twice as many cells on a tile as the first, not the same few twice.
TEST(Noise, EveryOctaveFillsTheTile) {
  double difference = 0;
  for (float x = 0.1F; x < 2; x += 0.25F) {
    const auto second = [](float u) {
      return fbmValue2({u, 0.4F}, {.octaves = 2, .period = 4}).value * 1.5F - valueNoise2({u, 0.4F}, {0, 4}).value;
    };
    difference += std::abs(second(x) - second(x + 2));
  }
  EXPECT_GT(difference, 0.3);
}

TEST(Noise, DerivativesAreThoseOfCentralDifferences) {
  constexpr float kStep = 0x1p-9F;
  for (const Kind2& kind : kKinds2)
    for (const Vec3 p : places(3000)) {
      const auto at = [&](float x, float y) { return kind.noise({p.x + x, p.y + y}, 0, 1).value; };
      const Noise2 noise = kind.noise({p.x, p.y}, 0, 1);
      ASSERT_NEAR(noise.gradient.x, (at(kStep, 0) - at(-kStep, 0)) / (2 * kStep), 0.01) << kind.name;
      ASSERT_NEAR(noise.gradient.y, (at(0, kStep) - at(0, -kStep)) / (2 * kStep), 0.01) << kind.name;
    }
  for (const Kind3& kind : kKinds3)
    for (const Vec3 p : places(3000)) {
      const auto at = [&](float x, float y, float z) { return kind.noise(p + Vec3{x, y, z}, 0, 1).value; };
      const Noise3 noise = kind.noise(p, 0, 1);
      ASSERT_NEAR(noise.gradient.x, (at(kStep, 0, 0) - at(-kStep, 0, 0)) / (2 * kStep), 0.01) << kind.name;
      ASSERT_NEAR(noise.gradient.y, (at(0, kStep, 0) - at(0, -kStep, 0)) / (2 * kStep), 0.01) << kind.name;
      ASSERT_NEAR(noise.gradient.z, (at(0, 0, kStep) - at(0, 0, -kStep)) / (2 * kStep), 0.01) << kind.name;
    }
}

TEST(Noise, TilesRepeatExactly) {
  for (const int period : {1, 3, 8}) {
    int differs = 0;
    for (int i = -20; i < 20; ++i)
      for (int j = -20; j < 20; ++j) {
        // Quarters of a cell, so that adding a period is exact.
        const Vec2 p{float(i) * 0.25F + 0.125F, float(j) * 0.75F + 0.125F};
        const Vec2 next{p.x + float(period), p.y - 2 * float(period)};
        for (const Kind2& kind : kKinds2) {
          const Noise2 here = kind.noise(p, period, 5), there = kind.noise(next, period, 5);
          ASSERT_EQ(here.value, there.value) << kind.name;
          ASSERT_EQ(here.gradient, there.gradient) << kind.name;
          differs += kind.noise(p, 0, 5).value != kind.noise(next, 0, 5).value;
        }
        for (const Kind3& kind : kKinds3)
          ASSERT_EQ(kind.noise({p.x, p.y, p.x}, period, 5).value, kind.noise({next.x, next.y, p.x + float(period)}, period, 5).value);
      }
    EXPECT_GT(differs, 6000);  // without a period it does not
  }
}

TEST(Noise, SeedsGiveOtherNoise) {
  for (const Kind2& kind : kKinds2) {
    double correlation = 0, square = 0;
    const double middle = (kind.low + kind.high) / 2;
    for (const Vec3 p : places(20000)) {
      const double a = kind.noise({p.x * 50, p.y * 50}, 0, 1).value - middle, b = kind.noise({p.x * 50, p.y * 50}, 0, 2).value - middle;
      correlation += a * b;
      square += a * a;
    }
    EXPECT_LT(std::abs(correlation / square), 0.03) << kind.name;
  }
}

TEST(Noise, OneOctaveIsTheNoiseItselfAndMoreAddFinerParts) {
  for (const Vec3 p : places(100)) {
    EXPECT_FLOAT_EQ(fbmValue3(p, {.octaves = 1, .seed = 4}).value, valueNoise3(p, {.seed = 4}).value);
    EXPECT_FLOAT_EQ(fbmGradient2({p.x, p.y}, {.octaves = 1, .seed = 4}).value, gradientNoise2({p.x, p.y}, {.seed = 4}).value);
  }
  double rough = 0, smooth = 0;
  for (const Vec3 p : places(5000)) {
    const Vec2 few = fbmGradient2({p.x, p.y}, {.octaves = 1}).gradient, many = fbmGradient2({p.x, p.y}, {.octaves = 6}).gradient;
    smooth += few.x * few.x + few.y * few.y;
    rough += many.x * many.x + many.y * many.y;
  }
  EXPECT_GT(rough, 1.2 * smooth);
}

TEST(Fbm, ValuesAloneAreTheSameToTheBit) {
  for (int i = 0; i < 20000; ++i) {
    const float x = float(i) * 0.37F - 3000, y = float(i % 97) * 1.9F - 50, z = float(i % 31) * -0.77F;
    for (const FbmSettings settings : {FbmSettings{}, FbmSettings{.octaves = 7, .gain = 0.6F, .seed = 5, .period = 12}}) {
      ASSERT_EQ(fbmValueOnly2({x, y}, settings), fbmValue2({x, y}, settings).value) << i;
      const float value = fbmValue3({x, y, z}, settings).value;
      ASSERT_EQ(fbmValueOnly3({x, y, z}, settings), value) << i;
      // With a limit: exact under it; from it on not under it, and not over the value.
      const float limited = fbmValueOnly3({x, y, z}, settings, 0.45F);
      if (value < 0.45F)
        ASSERT_EQ(limited, value) << i;
      else
        ASSERT_TRUE(limited >= 0.45F && limited <= value) << i << " " << limited << " " << value;
    }
  }
}

}  // namespace
}  // namespace cloudbake
