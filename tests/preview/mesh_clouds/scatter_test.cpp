// Fields of clouds: where their clouds are at first, and where the wind takes them.
#include "preview/mesh_clouds/scatter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace cloudbake {
namespace {

constexpr std::array<double, 1> kOne{1};

ScatterSettings boxOfField() {
  ScatterSettings settings;
  settings.low = {-50, 10, -20}, settings.high = {50, 14, 30};
  settings.count = 2000;
  return settings;
}

bool isInside(Vec3 p, Vec3 low, Vec3 high) {
  return p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y && p.z >= low.z && p.z <= high.z;
}

bool areSame(const ScatteredCloud& a, const ScatteredCloud& b) {
  return a.place == b.place && a.turn_degrees == b.turn_degrees && a.size == b.size && a.mesh == b.mesh;
}

Vec3 placeOf(const Affine& m) { return {float(m.offset[0]), float(m.offset[1]), float(m.offset[2])}; }

double scaleOf(const Affine& m) { return std::cbrt(determinant(m)); }

// Factor of the cloud's size at a time, and its place.
struct Seen {
  Vec3 place;
  double scale;
};
Seen seenAt(const ScatterSettings& settings, const ScatteredCloud& cloud, double seconds) {
  const Affine m = placeAt(settings, cloud, {}, seconds);
  return {placeOf(m), scaleOf(m)};
}

// --- At first ---

TEST(ScatterClouds, FillsTheBoxEvenly) {
  const ScatterSettings settings = boxOfField();
  const std::vector<ScatteredCloud> clouds = scatterClouds(settings, kOne);
  ASSERT_EQ(clouds.size(), 2000U);
  std::array<int, 20> in_cell{};
  Vec3 sum;
  for (const ScatteredCloud& cloud : clouds) {
    EXPECT_TRUE(isInside(cloud.place, settings.low, settings.high));
    const auto column = std::min(4U, unsigned((cloud.place.x + 50) / 20)), row = std::min(3U, unsigned((cloud.place.z + 20) / 12.5F));
    ++in_cell[row * 5 + column];
    sum += cloud.place;
  }
  for (const int count : in_cell) EXPECT_NEAR(count, 100, 25) << "stratified: independent places would be off by 40";
  const Vec3 mean = sum / 2000;
  EXPECT_NEAR(mean.x, 0, 1.5);
  EXPECT_NEAR(mean.y, 12, 0.1);
  EXPECT_NEAR(mean.z, 5, 1);
}

TEST(ScatterClouds, IsAGridWithoutJitter) {
  ScatterSettings settings = boxOfField();
  settings.count = 8, settings.jitter = 0;  // two rows of four squares of 25 units
  const std::vector<ScatteredCloud> clouds = scatterClouds(settings, kOne);
  ASSERT_EQ(clouds.size(), 8U);
  for (size_t i = 0; i < clouds.size(); ++i) {
    const size_t column = i % 4, row = i / 4;
    EXPECT_EQ(clouds[i].place, (Vec3{-37.5F + 25 * float(column), 12, -7.5F + 25 * float(row)})) << i;
  }
  settings.count = 1;
  EXPECT_EQ(scatterClouds(settings, kOne).at(0).place, (Vec3{0, 12, 5})) << "one cloud is in the middle";
}

// Half of the jitter moves clouds half as far from the middle of their cells.
TEST(ScatterClouds, JitterMovesWithinTheCell) {
  ScatterSettings settings = boxOfField();
  settings.count = 200;
  const auto at = [&](float jitter) {
    settings.jitter = jitter;
    return scatterClouds(settings, kOne);
  };
  const auto grid = at(0), half = at(0.5F), whole = at(1);
  for (size_t i = 0; i < grid.size(); ++i) EXPECT_LT(length(half[i].place - (grid[i].place + whole[i].place) / 2), 1e-4) << i;
}

TEST(ScatterClouds, TakesProbabilityTurnSizeAndWeights) {
  ScatterSettings settings = boxOfField();
  settings.count = 10000, settings.probability = 0.3F, settings.turn_degrees = 90, settings.size = {0.5F, 2};
  const std::vector<ScatteredCloud> clouds = scatterClouds(settings, std::array<double, 3>{3, 2, 1});
  EXPECT_NEAR(double(clouds.size()), 3000, 4 * std::sqrt(10000 * 0.3 * 0.7));
  std::array<double, 3> of_mesh{};
  double turns = 0, turned = 0, sizes = 0;
  for (const ScatteredCloud& cloud : clouds) {
    ++of_mesh[cloud.mesh];
    turns += cloud.turn_degrees, turned += std::abs(cloud.turn_degrees), sizes += cloud.size;
    EXPECT_LE(std::abs(cloud.turn_degrees), 90);
    EXPECT_TRUE(cloud.size >= 0.5F && cloud.size <= 2);
  }
  const auto count = double(clouds.size());
  EXPECT_NEAR(of_mesh[0] / count, 3 / 6.0, 0.04);
  EXPECT_NEAR(of_mesh[1] / count, 2 / 6.0, 0.04);
  EXPECT_NEAR(turns / count, 0, 4);
  EXPECT_NEAR(turned / count, 45, 3);
  EXPECT_NEAR(sizes / count, 1.25, 0.04);
}

TEST(ScatterClouds, KeepsAMinimumDistanceAlsoAroundTheBox) {
  ScatterSettings settings = boxOfField();
  settings.minimum_distance = 4, settings.drift = {1, 0, 0};
  const std::vector<ScatteredCloud> clouds = scatterClouds(settings, kOne);
  EXPECT_GT(clouds.size(), 100U);
  const auto nearest = [&](double seconds) {
    double least = INFINITY;
    for (size_t i = 0; i < clouds.size(); ++i)
      for (size_t j = 0; j < i; ++j)
        least = std::min(
            least, double(length(placeOf(placeAt(settings, clouds[i], {}, seconds)) - placeOf(placeAt(settings, clouds[j], {}, seconds)))));
    return least;
  };
  EXPECT_GE(nearest(0), 4);
  EXPECT_GE(nearest(33), 4 - 1e-3) << "clouds that have wrapped around";
  ScatterSettings loose = settings;
  loose.minimum_distance = 0;
  EXPECT_EQ(scatterClouds(loose, kOne).size(), 2000U);
  settings.minimum_distance = 1e6F;
  EXPECT_EQ(scatterClouds(settings, kOne).size(), 1U) << "one that leaves no place is no error";
}

TEST(ScatterClouds, FollowsTheSeed) {
  ScatterSettings settings = boxOfField();
  const auto one = scatterClouds(settings, kOne), again = scatterClouds(settings, kOne);
  settings.seed = 2;
  const auto other = scatterClouds(settings, kOne);
  int same = 0;
  for (size_t i = 0; i < one.size(); ++i) {
    EXPECT_TRUE(areSame(one[i], again[i]));
    same += areSame(one[i], other[i]);
  }
  EXPECT_EQ(same, 0);
  // A cloud does not change with the probability of others.
  settings.probability = 0.5F;
  for (const ScatteredCloud& cloud : scatterClouds(settings, kOne))
    EXPECT_TRUE(std::any_of(other.begin(), other.end(), [&](const ScatteredCloud& one_of) { return areSame(cloud, one_of); }));
}

// --- In the wind ---

TEST(PlaceAt, PlacesTurnsAndScales) {
  ScatterSettings settings = boxOfField();
  Affine base;
  base.linear[1][1] = 2;
  const Affine m = placeAt(settings, {{3, 11, 4}, 90, 0.5F, 0}, base, 7);
  const Vec3 x = transformPoint(m, {1, 0, 0}), y = transformPoint(m, {0, 1, 0});
  EXPECT_LT(length(x - Vec3{3, 11, 3.5F}), 1e-5) << "a quarter turn about y takes +X to -Z, as that of a placed cloud does";
  EXPECT_LT(length(y - Vec3{3, 12, 4}), 1e-5);
}

TEST(PlaceAt, MovesWithoutAJump) {
  ScatterSettings settings = boxOfField();
  settings.drift = {2, 0, -1}, settings.horizon_scale = 0.4F, settings.horizon_lower = 5;
  for (const ScatteredCloud& cloud : {ScatteredCloud{{-49, 12, 0}, 30, 1.5F, 0}, ScatteredCloud{{10, 13, 29}, -70, 0.7F, 0}}) {
    Seen before = seenAt(settings, cloud, 0);
    int wraps = 0;
    for (int step = 1; step <= 20000; ++step) {
      const Seen now = seenAt(settings, cloud, step / 100.0);
      EXPECT_LT(std::abs(now.scale - before.scale), 0.02);
      if (length(now.place - before.place) > 1) {
        ++wraps;
        EXPECT_LT(std::max(now.scale, before.scale), 0.01) << "a wrap around that is seen";
      } else {
        EXPECT_LT(length(now.place - before.place), 0.1);
      }
      EXPECT_GE(now.scale, cloud.size * kLeastShrink * 0.999);
      before = now;
    }
    EXPECT_EQ(wraps, 4 + 4) << "200 s are four boxes along x, and four along z";
  }
}

TEST(PlaceAt, IsTheSameAfterWholeBoxes) {
  ScatterSettings settings = boxOfField();
  settings.drift = {2, 0, -1};
  const ScatteredCloud cloud{{-49, 12, 0}, 30, 1, 0};
  EXPECT_TRUE(repeatsAfter(settings, 50));
  EXPECT_FALSE(repeatsAfter(settings, 25)) << "half a box along z";
  const Affine now = placeAt(settings, cloud, {}, 3), later = placeAt(settings, cloud, {}, 53);
  EXPECT_LT(length(placeOf(now) - placeOf(later)), 1e-3);
  EXPECT_EQ(placeAt(settings, cloud, {}, 0).offset, (std::array<double, 3>{-49, 12, 0}));
  settings.drift = {};
  EXPECT_TRUE(repeatsAfter(settings, 0.3));
}

TEST(PlaceAt, IsSmallerAndLowerTowardsTheHorizon) {
  ScatterSettings settings = boxOfField();
  settings.horizon_scale = 0.2F, settings.horizon_lower = 8;
  const auto at = [&](float x, float z) { return seenAt(settings, {{x, 12, z}, 0, 1, 0}, 0); };
  EXPECT_NEAR(at(0, 5).scale, 1, 1e-6);
  EXPECT_NEAR(at(0, 5).place.y, 12, 1e-6);
  EXPECT_NEAR(at(50, 5).scale, 0.2, 1e-6);
  EXPECT_NEAR(at(50, 5).place.y, 4, 1e-5);
  EXPECT_NEAR(at(0, 30).scale, 0.2, 1e-6) << "the horizon is as near as the box is short";
  EXPECT_NEAR(at(25, 5).scale, 1 - 0.8 / 4, 1e-6);
  EXPECT_NEAR(at(25, 5).place.y, 10, 1e-5);
  EXPECT_NEAR(at(50, 30).scale, 0.2, 1e-6) << "beyond it";
}

TEST(FieldBox, HasAllCloudsAtAllTimes) {
  ScatterSettings settings = boxOfField();
  settings.drift = {2, 0.5F, -1}, settings.horizon_scale = 1.5F, settings.horizon_lower = 5, settings.size = {0.5F, 2};
  const Box box = fieldBox(settings, 3);
  for (const ScatteredCloud& cloud : scatterClouds(settings, kOne))
    for (const double seconds : {0.0, 13.0, 77.7}) {
      const Affine m = placeAt(settings, cloud, {}, seconds);
      for (const Vec3 corner : {Vec3{3, 0, 0}, Vec3{0, -3, 0}, Vec3{0, 3, 0}, Vec3{0, 0, -3}})
        EXPECT_TRUE(isInside(transformPoint(m, corner), box.low, box.high));
    }
}

}  // namespace
}  // namespace cloudbake
