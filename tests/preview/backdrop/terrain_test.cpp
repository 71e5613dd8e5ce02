// The terrain against the numbers of its source: ground, march, shadow, snow, light, sky, fog and the camera's path.
#include "preview/backdrop/terrain.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "core/random.h"
#include "preview/backdrop/noise.h"

namespace cloudbake {
namespace {

constexpr double kScale = 250;
const Vec3 kToSun{-0.8479983F, 0.42399916F, -0.31799936F};  // along (−8, 4, −3)

// A draw in [0, 1) for sample i.
double draw(int i, uint32_t what) { return uniformFloat(hashDraw(11, uint32_t(i), what)); }

double smoothStepOf(double a, double b, double x) {
  const double t = std::clamp((x - a) / (b - a), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

void expectComponents(Vec3 found, const std::array<double, 3>& expected, double tolerance, const char* what = "") {
  EXPECT_NEAR(found.x, expected[0], tolerance) << what;
  EXPECT_NEAR(found.y, expected[1], tolerance) << what;
  EXPECT_NEAR(found.z, expected[2], tolerance) << what;
}

Vec3 unit(Vec3 v) { return normalized(v).value_or(Vec3{0, 1, 0}); }

// A ground at half the amplitude's height everywhere that the octaves leave alone: without octaves it is level at the origin's height.
TerrainSettings levelGround() {
  TerrainSettings settings;
  settings.shape.march_octaves = settings.shape.normal_octaves = settings.shape.camera_octaves = 0;
  return settings;
}

// The sum by hand, the lattice noise taken from preview/noise: weights .5 … .0625 over .9375, turned by arctan(3/4) and scaled.
TEST(Terrain, FbmHasItsWeightsLacunaritiesAndTurn) {
  const auto by_hand = [](double x, double y, uint32_t seed) {
    const double weights[]{0.5, 0.25, 0.125, 0.0625}, lacunarities[]{2.02, 2.03, 2.01, 1};
    double sum = 0;
    for (int i = 0; i < 4; ++i) {
      sum += weights[i] / 0.9375 * valueNoise2({float(x), float(y)}, {.seed = seed + uint32_t(i) * 0x632BE5ABU}).value;
      const double turned_x = 0.8 * x - 0.6 * y, turned_y = 0.6 * x + 0.8 * y;
      x = lacunarities[i] * turned_x;
      y = lacunarities[i] * turned_y;
    }
    return sum;
  };
  double low = 1, high = 0, mean = 0;
  constexpr int kCount = 20000;
  for (int i = 0; i < kCount; ++i) {
    const Vec2 p{float(200 * draw(i, 0) - 100), float(200 * draw(i, 1) - 100)};
    const double value = terrainFbm(p, 5);
    ASSERT_NEAR(value, by_hand(p.x, p.y, 5), 1e-3);
    low = std::min(low, value);
    high = std::max(high, value);
    mean += value / kCount;
  }
  EXPECT_TRUE(low >= 0 && high <= 1);
  EXPECT_LT(low, 0.25);
  EXPECT_GT(high, 0.75);
  EXPECT_NEAR(mean, 0.5, 0.01);
}

// 120 SC Σ 2⁻ⁱ n/(1 + |Σ∇n|²), p₀ = 0.003 x/SC, turned and doubled.
double heightByHand(double x, double z, int octaves, double scale = kScale) {
  double px = 0.003 * x / scale, py = 0.003 * z / scale, sum = 0, slope_x = 0, slope_y = 0;
  for (int i = 0; i < octaves; ++i) {
    const Noise2 noise = valueNoise2({float(px), float(py)}, {.seed = uint32_t(i) * 0x632BE5ABU});
    slope_x += noise.gradient.x;
    slope_y += noise.gradient.y;
    sum += std::pow(0.5, i) * noise.value / (1 + slope_x * slope_x + slope_y * slope_y);
    const double turned_x = 0.8 * px - 0.6 * py, turned_y = 0.6 * px + 0.8 * py;
    px = 2 * turned_x;
    py = 2 * turned_y;
  }
  return 120 * scale * sum;
}

TEST(Terrain, HeightIsTheErodedSum) {
  const TerrainSettings settings;
  double highest = 0;
  for (int i = 0; i < 3000; ++i) {
    const double x = (draw(i, 0) - 0.5) * 4000 * kScale, z = (draw(i, 1) - 0.5) * 4000 * kScale;
    for (const int octaves : {0, 1, 3, 9, 16})
      ASSERT_NEAR(terrainHeight(x, z, octaves, settings), heightByHand(x, z, octaves), 0.01 * kScale) << octaves;
    highest = std::max(highest, terrainHeight(x, z, 16, settings));
  }
  EXPECT_LT(highest, 240 * kScale);
  EXPECT_GT(highest, 80 * kScale);  // snow has a place
  EXPECT_EQ(settings.shape.camera_octaves, 3);
  EXPECT_EQ(settings.shape.march_octaves, 9);
  EXPECT_EQ(settings.shape.normal_octaves, 16);
}

TEST(Terrain, EachOctaveAddsLessThanHalfOfTheLast) {
  const TerrainSettings settings;
  double mean_slope = 0;
  for (int i = 0; i < 2000; ++i) {
    const double x = draw(i, 0) * 1e6, z = draw(i, 1) * 1e6;
    double last = 0;
    for (int octaves = 1; octaves <= 16; ++octaves) {
      const double height = terrainHeight(x, z, octaves, settings), most = 120 * kScale * std::pow(0.5, octaves - 1);
      ASSERT_GE(height - last, -1e-3);
      ASSERT_LE(height - last, most * (1 + 1e-5) + 1e-2);
      last = height;
    }
    // Without the divisor the same octaves reach higher.
    mean_slope +=
        heightByHand(x, z, 1) / (120 * kScale * double(valueNoise2({float(0.003 * x / kScale), float(0.003 * z / kScale)}).value));
  }
  EXPECT_LT(mean_slope / 2000, 0.9);
}

TEST(Terrain, ScaleAndOriginCarryThePictureOver) {
  const TerrainSettings plain;
  TerrainSettings moved;
  moved.scale = 0.5F;
  moved.origin = {32, -8, 64};
  const Vec3 view = unit({0.3F, -0.2F, 1});
  for (int i = 0; i < 100; ++i) {
    const double x = draw(i, 0) * 1000, z = draw(i, 1) * 1000;  // SC
    const double height = terrainHeight(x * 250, z * 250, 9, plain) / 250;
    ASSERT_NEAR((terrainHeight(32 + x * 0.5, 64 + z * 0.5, 9, moved) + 8) / 0.5, height, 1e-3);
    const Ray ray{{float(x * 250), float((height + 20) * 250), float(z * 250)}, view};
    const Ray there{{float(32 + x * 0.5), float(-8 + (height + 20) * 0.5), float(64 + z * 0.5)}, view};
    const auto hit = marchTerrain(ray, plain), same = marchTerrain(there, moved);
    ASSERT_EQ(bool(hit), bool(same));
    if (!hit) continue;
    ASSERT_NEAR(same->distance / 0.5, hit->distance / 250, 0.01 * hit->distance / 250);
    EXPECT_NEAR(terrainFog(same->distance, moved), terrainFog(hit->distance, plain), 0.01);
    // The same ground, material and shadow, to the rounding of positions in float.
    const Vec3 place{float(32 + x * 0.5), float(-8 + height * 0.5), float(64 + z * 0.5)};
    const Vec3 original{float(x * 250), float(height * 250), float(z * 250)};
    EXPECT_LT(length(terrainNormal(place.x, place.z, 0.5, moved) - terrainNormal(original.x, original.z, 250, plain)), 0.01F);
    EXPECT_LT(length(terrainMaterial(place, view, moved).albedo - terrainMaterial(original, view, plain).albedo), 0.01F);
  }
  const TerrainCamera here = terrainPath(20, plain), there = terrainPath(20, moved);
  expectComponents((there.position - moved.origin) * 2, {here.position.x / 250, here.position.y / 250, here.position.z / 250}, 1e-3);
  expectComponents((there.target - moved.origin) * 2, {here.target.x / 250, here.target.y / 250, here.target.z / 250}, 1e-3);
}

TEST(Terrain, SeedsGiveOtherMountains) {
  TerrainSettings other;
  other.seed = 1;
  int differs = 0;
  for (int i = 0; i < 100; ++i) differs += std::abs(terrainHeight(i * 5e4, 7, 9, {}) - terrainHeight(i * 5e4, 7, 9, other)) > kScale;
  EXPECT_GT(differs, 80);
}

// The difference of heights along the normal's tangents vanishes; level ground has the normal up.
TEST(Terrain, NormalIsThatOfDifferencesOfHeights) {
  const TerrainSettings settings;
  const double step = 0.5 * kScale;
  double steepest = 1;
  for (int i = 0; i < 1000; ++i) {
    const double x = draw(i, 0) * 1e6, z = draw(i, 1) * 1e6;
    const Vec3 n = terrainNormal(x, z, step, settings);
    EXPECT_NEAR(length(n), 1, 1e-5);
    const double along_x = (heightByHand(x + step, z, 16) - heightByHand(x - step, z, 16)) / (2 * step);
    const double along_z = (heightByHand(x, z + step, 16) - heightByHand(x, z - step, 16)) / (2 * step);
    const double norm = std::sqrt(along_x * along_x + along_z * along_z + 1);
    expectComponents(n, {-along_x / norm, 1 / norm, -along_z / norm}, 2e-3);
    steepest = std::min(steepest, double(n.y));
  }
  EXPECT_LT(steepest, 0.6);
  EXPECT_EQ(terrainNormal(3, 4, 1, levelGround()), (Vec3{0, 1, 0}));
}

// Heights above the ground at a distance along a ray.
double above(const Ray& ray, double t) {
  return double(ray.origin.y) + t * double(ray.direction.y) -
         terrainHeight(double(ray.origin.x) + t * double(ray.direction.x), double(ray.origin.z) + t * double(ray.direction.z), 9, {});
}

// The first crossing, found by small steps and bisection; infinite where there is none before `last`.
double firstCrossing(const Ray& ray, double last) {
  for (double t = 1; t < last;) {
    const double next = t + std::max(0.02 * kScale, 0.0008 * t);
    if (above(ray, next) < 0) {
      double low = t, high = next;
      for (int i = 0; i < 40; ++i) (above(ray, 0.5 * (low + high)) > 0 ? low : high) = 0.5 * (low + high);
      return low;
    }
    t = next;
  }
  return INFINITY;
}

TEST(Terrain, MarchEndsWhereBisectionFindsTheGround) {
  const TerrainSettings settings;
  EXPECT_EQ(settings.march.step, 0.4F);
  EXPECT_EQ(settings.march.steps, 300);
  int hits = 0, near_truth = 0, early_or_late = 0;
  for (int i = 0; i < 400; ++i) {
    const TerrainCamera camera = terrainPath(draw(i, 0) * 1000, settings);
    const auto dy = float(-0.6 * draw(i, 1) + 0.05), turn = float(2 * kPi * draw(i, 2));
    const Ray ray{camera.position, unit({std::cos(turn), dy, std::sin(turn)})};
    const auto hit = marchTerrain(ray, settings);
    if (!hit) continue;
    ++hits;
    ASSERT_LT(std::abs(above(ray, hit->distance)), 0.00151 * hit->distance);
    expectComponents(hit->position - ray.origin - ray.direction * float(hit->distance), {0, 0, 0}, 0.1);
    // It stops within 0.0015t above the ground, and no crossing lies before: on the way to the truth the ray stays as low.
    const double truth = firstCrossing(ray, 1.05 * hit->distance);
    if (std::abs(truth - hit->distance) < 0.01 * hit->distance) ++near_truth;
    if (truth < 0.97 * hit->distance) ++early_or_late;
  }
  EXPECT_GT(hits, 300);
  EXPECT_GT(near_truth, hits * 94 / 100);
  EXPECT_LE(early_or_late, hits / 100);
}

TEST(Terrain, MarchTakesStepsOfItsShareOfTheHeight) {
  // Straight down on level ground from the height H, t ← t + 0.4 (H − t): what is left shrinks by 0.6 a step.
  TerrainSettings settings = levelGround();
  const Ray down{{0, 10000, 0}, {0, -1, 0}};
  const auto hit = marchTerrain(down, settings);
  ASSERT_TRUE(hit);
  double rest = 10000 - 1;
  while (rest >= 0.0015 * (10000 - rest)) rest *= 0.6;
  EXPECT_NEAR(hit->distance, 10000 - rest, 0.01);
  settings.march.steps = 3;
  EXPECT_NEAR(marchTerrain(down, settings)->distance, 10000 - 9999 * 0.6 * 0.6 * 0.6, 0.01);
  // Steps that lead below the ground are followed by steps back.
  settings.march.steps = 300, settings.march.step = 1.2F;
  EXPECT_NEAR(marchTerrain(down, settings)->distance, 9999, 0.0015 * 10000);
}

TEST(Terrain, RaysAreClippedToWhatLiesBelowTheCeiling) {
  TerrainSettings settings = levelGround();
  // Above 300 SC: nothing to be seen above, and below from the ceiling on.
  settings.march.steps = 0;
  const Ray down{{0, 400 * 250, 0}, {0, -1, 0}};
  EXPECT_NEAR(marchTerrain(down, settings)->distance, 100 * kScale, 1e-6);
  EXPECT_FALSE(marchTerrain({{0, 400 * 250, 0}, {1, 0, 0}}, settings));
  EXPECT_FALSE(marchTerrain({{0, 400 * 250, 0}, {0, 1, 0}}, settings));
  // From below a ray leaves by it: at 1 SC under the ceiling the first step, 0.4·299 SC straight up, is beyond.
  settings.march.steps = 1;
  EXPECT_FALSE(marchTerrain({{0, 299 * 250, 0}, {0, 1, 0}}, settings));
  settings.march.ceiling = 600;
  EXPECT_TRUE(marchTerrain({{0, 299 * 250, 0}, {0, 1, 0}}, settings));
  settings.march.steps = 300;
  EXPECT_FALSE(marchTerrain({{0, 299 * 250, 0}, {1, 0, 0}}, settings));  // level over level ground: past the farthest
}

TEST(Terrain, ShadowIsTheLeastClearanceOnTheWay) {
  const TerrainSettings level = levelGround();
  EXPECT_EQ(terrainShadow({0, 0, 0}, unit({1, 1, 0}), level), 1);
  EXPECT_EQ(terrainShadow({0, 0, 0}, unit({1, -1, 0}), level), 0);
  // Sine e, lift d: the height at t is (d + t)e, so d + t grows by 1 + e a step, and the least of 16 (d + t)e/t is met at the 80th.
  const Vec3 low_sun = unit({1, 0.02F, 0});
  const double e = low_sun.y, way = std::pow(1 + e, 79) - 1;
  EXPECT_NEAR(terrainShadow({0, 0, 0}, low_sun, level), 16 * e * (1 + 1 / way), 1e-4);
  // Under ground it is dark.
  EXPECT_EQ(terrainShadow({0, -100, 0}, {0, 1, 0}, level), 0);
  // The way ends above 200 SC.
  EXPECT_EQ(terrainShadow({0, 201 * 250, 0}, unit({1, -1, 0}), level), 1);
  EXPECT_LT(terrainShadow({0, 199 * 250, 0}, unit({1, -1, 0}), level), 1);
  // The lift of 0.05 SC brings a point just under ground into the light.
  EXPECT_GT(terrainShadow({0, -10, 0}, {0, 1, 0}, level), 0.5F);
  EXPECT_EQ(terrainShadow({0, -15, 0}, {0, 1, 0}, level), 0);
}

TEST(Terrain, ShadowGrowsWithHeightAndIsDarkBehindRidges) {
  const TerrainSettings settings;
  TerrainSettings patient;
  patient.shadow.steps = 2000;
  const Vec3 to_sun = unit({-0.8F, 0.25F, -0.3F});
  int dark = 0, leaks = 0, open = 0, rises = 0, falls = 0;
  for (int i = 0; i < 400; ++i) {
    const double x = (draw(i, 0) - 0.5) * 5e5, z = (draw(i, 1) - 0.5) * 5e5, ground = terrainHeight(x, z, 9, settings);
    const auto at = [&](double height) { return terrainShadow({float(x), float(ground + height * kScale), float(z)}, to_sun, settings); };
    // Truth of "deep behind a ridge": the straight line to the sun runs 3 SC under the ground somewhere.
    const Ray ray{{float(x), float(ground + 0.05 * kScale), float(z)}, to_sun};
    double lowest = INFINITY;
    for (double t = 0; t < 400 * kScale; t += 0.2 * kScale) lowest = std::min(lowest, above(ray, t));
    if (lowest < -3 * kScale) {
      ++dark;
      leaks += at(0) > 0.05F;
      EXPECT_LT(terrainShadow({float(x), float(ground), float(z)}, to_sun, patient), 0.01F);
    }
    if (lowest > -1e-3 && at(2) == 1) ++open;
    float last = -1;
    for (const double height : {0.0, 2.0, 5.0, 10.0, 20.0, 40.0, 80.0}) {
      const float shadow = at(height);
      ASSERT_TRUE(shadow >= 0 && shadow <= 1);
      rises += shadow > last + 1e-3F;
      falls += shadow < last - 0.03F;  // few samples of a sharp crest
      last = shadow;
    }
    EXPECT_EQ(at(200.1), 1);
  }
  EXPECT_GT(dark, 50);
  EXPECT_LE(leaks, dark / 20);  // 80 steps may end before a far ridge
  EXPECT_GT(open, 20);
  EXPECT_GT(rises, 400);
  EXPECT_LE(falls, rises / 50);
}

// s = h·e·o, and the mix by ss(.1, .9, s).
TEST(Terrain, SnowLiesHighOnGentleSlopesAndLessTowardsTheSun) {
  const TerrainSettings settings;
  const auto snow = [&](double y_sc, Vec3 n) { return terrainMaterial({312345, float(y_sc * kScale), 234567}, unit(n), settings).snow; };
  EXPECT_EQ(snow(29, {0, 1, 0}), 0);  // 29 + 25 < 55
  EXPECT_EQ(snow(81, {0, 1, 0}), 1);
  EXPECT_EQ(snow(81, {0, 0, 1}), 0);
  double last = 0;
  for (double y = 29; y < 82; y += 1) {
    const double here = snow(y, {0, 1, 0});
    EXPECT_GE(here, last);
    last = here;
  }
  // All of it above 80 SC: e = ss(.5, .9, n.y), o = 1 as n.x + h² > 0.1 for n.x > −0.9.
  for (const double ny : {0.45, 0.55, 0.6, 0.7, 0.8, 0.95})
    EXPECT_NEAR(snow(90, {0, float(ny), float(std::sqrt(1 - ny * ny))}), smoothStepOf(0.5, 0.9, ny), 1e-5) << ny;
  // Between: the height at which snow is whole tells the noise, as 80 = y + 25 fbm.
  double low = 50, high = 81;
  for (int i = 0; i < 40; ++i) (snow(0.5 * (low + high), {0, 1, 0}) < 1 ? low : high) = 0.5 * (low + high);
  const double noise = 80 - high;
  EXPECT_NEAR(noise, 25 * double(terrainFbm({float(0.01 * 312345 / kScale), float(0.01 * 234567 / kScale)}, 0x6C8E9CF5)), 0.02);
  int bare_side = 0;
  for (double y = 30; y < 80; y += 0.25) {
    const double h = smoothStepOf(55, 80, y + noise);
    if (h < 0.05) continue;
    for (const Vec3 n : {Vec3{0, 1, 0}, Vec3{-0.4F, 1, 0}, Vec3{0.4F, 1, 0}, Vec3{-0.2F, 1, 0.2F}, Vec3{-0.05F, 1, 0}}) {
      const Vec3 normal = unit(n);
      const double e = smoothStepOf(1 - 0.5 * h, 1 - 0.1 * h, normal.y), o = 0.3 + 0.7 * smoothStepOf(0, 0.1, normal.x + h * h);
      EXPECT_NEAR(snow(y, n), h * e * o, 4e-3) << y << " " << n.x;
      bare_side += h * e > 0.1 && o < 0.5;
    }
  }
  EXPECT_GT(bare_side, 10);
  const TerrainMaterial white = terrainMaterial({1000, 90 * 250, 2000}, {0, 1, 0}, settings);
  expectComponents(white.albedo, {0.29 * 0.62, 0.29 * 0.65, 0.29 * 0.70}, 1e-5);
}

// Snow is whole where y/SC + 25 fbm(.01 xz/SC) reaches 80, and begins at 55.
TEST(Terrain, SnowLineWandersWithItsNoise) {
  const TerrainSettings settings;
  for (int i = 0; i < 50; ++i) {
    const double x = 1e6 * draw(i, 0), z = 1e6 * draw(i, 1);
    const double noise = 25 * double(terrainFbm({float(0.01 * x / kScale), float(0.01 * z / kScale)}, 0x6C8E9CF5));
    const auto snow = [&](double y) { return terrainMaterial({float(x), float(y * kScale), float(z)}, {0, 1, 0}, settings).snow; };
    EXPECT_EQ(snow(80.1 - noise), 1);
    EXPECT_TRUE(snow(79 - noise) < 1 && snow(79 - noise) > 0.98F);
    EXPECT_EQ(snow(54.9 - noise), 0);
    EXPECT_GT(snow(57 - noise), 0);
  }
}

// At a place of known noise: r, strata and grain from their definitions.
TEST(Terrain, RockAndGrassAreTheirFormulas) {
  const TerrainSettings settings;
  double grass_beside_rock = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 point{float(1e5 * draw(i, 0)), float(20 * kScale * draw(i, 1)), float(1e5 * draw(i, 2))};
    const double x = point.x / kScale, y = point.y / kScale, z = point.z / kScale;
    const auto picture = [](double u, double v) {
      return double(valueNoise2({float(256 * u), float(256 * v)}, {.seed = 0x2545F491, .period = 256}).value);
    };
    const double r = picture(7 * x / 256, 7 * z / 256), stratum = picture(0.00007 * x, 0.00007 * 48 * y);
    // .04xz and .005xz at SC = 250.
    const double fine = terrainFbm({0.04F * point.x, 0.04F * point.z}, 0x51ED270B);
    const double coarse = terrainFbm({0.005F * point.x, 0.005F * point.z}, 0x51ED270B);
    const double grain = 0.1 + 1.8 * std::sqrt(fine * coarse);
    for (const double ny : {0.3, 0.8, 0.93, 0.97, 1.0}) {
      const Vec3 normal{0, float(ny), float(std::sqrt(1 - ny * ny))};
      std::array<double, 3> expected;
      const double dark[]{.08, .05, .03}, light[]{.10, .09, .08}, grass[]{.45, .3, .15}, meadow[]{.3, .3, .1};
      for (int c = 0; c < 3; ++c) {
        double value = (0.25 * r + 0.75) * 0.9 * (dark[c] + (light[c] - dark[c]) * stratum);
        const double first = smoothStepOf(0.7, 0.9, ny), second = smoothStepOf(0.95, 1, ny);
        value += (0.2 * grass[c] * (0.5 + 0.5 * r) - value) * first;
        value += (0.15 * meadow[c] * (0.25 + 0.75 * r) - value) * second;
        expected[size_t(c)] = value * grain;
      }
      expectComponents(terrainMaterial(point, normal, settings).albedo, expected, 1e-3);
    }
    grass_beside_rock +=
        terrainMaterial(point, {0, 0.94F, 0.34F}, settings).albedo.x / terrainMaterial(point, {0, 0, 1}, settings).albedo.x;
  }
  EXPECT_LT(grass_beside_rock / 200, 1.5);
}

// Level ground, no fog, all albedo as the material has it: each light's part.
TEST(Terrain, LightIsSunSkyBounceAndGloss) {
  TerrainSettings settings = levelGround();
  settings.use_own_fog = settings.use_sun_scatter = false;
  const TerrainHit hit{1000, {700, 0, 300}};
  const Vec3 n{0, 1, 0}, albedo = terrainMaterial(hit.position, n, settings).albedo;
  const double albedos[]{albedo.x, albedo.y, albedo.z};
  for (const double elevation : {80.0, 30.0, 2.0, -20.0}) {
    const Vec3 to_sun = directionFromAngles(70, float(elevation)), view = directionFromAngles(200, -35);
    const double facing = std::max(0.0, double(to_sun.y)), s = facing > 0 ? terrainShadow(hit.position, to_sun, settings) : 0;
    const double shadow[]{s, s * s / 2 + s / 2, 0.8 * s * s + 0.2 * s};
    const double sun[]{8, 5, 3}, sky[]{.4, .6, 1}, bounce[]{.4, .5, .6}, gloss[]{7, 5, 3};
    const Vec3 half = unit(to_sun - view);
    const double fresnel = 0.04 + 0.96 * std::pow(1 + double(dot(half, view)), 5);
    std::array<double, 3> expected;
    for (int c = 0; c < 3; ++c) {
      const double lit = sun[c] * 1.3 * shadow[c] * facing + sky[c] * 1.2 * 1.0 + bounce[c] * 0.2;
      expected[size_t(c)] = albedos[c] * lit + gloss[c] * facing * s * std::pow(double(half.y), 16) * fresnel * 0.7;
    }
    expectComponents(terrainColor(hit, view, to_sun, settings), expected, 2e-4, std::to_string(elevation).c_str());
    if (elevation == 2) {
      EXPECT_TRUE(s > 0.05 && s < 0.95) << "the coloured rim of a shadow is met";
    }
  }
}

TEST(Terrain, BounceComesFromAcrossAndSnowHasARim) {
  TerrainSettings settings;
  settings.use_own_fog = settings.use_sun_scatter = false;
  // What the bounce adds is albedo · (.4, .5, .6) · clamp(.2 + .8 n·normalize(−l.x, 0, l.z)).
  TerrainSettings without = settings;
  without.light.bounce = {};
  TerrainSettings no_rim = settings;
  no_rim.light.snow_rim = {};
  const Vec3 flat_sun = unit({-kToSun.x, 0, kToSun.z});
  int bounced = 0, rims = 0;
  for (int i = 0; i < 400; ++i) {
    const TerrainCamera camera = terrainPath(draw(i, 0) * 500, settings);
    const Vec3 view = unit(camera.target - camera.position + Vec3{0, float(draw(i, 1) * -2e4), 0});
    const auto hit = marchTerrain({camera.position, view}, settings);
    if (!hit) continue;
    const Vec3 n = terrainNormal(hit->position.x, hit->position.z, 0.001 * hit->distance, settings);
    const TerrainMaterial material = terrainMaterial(hit->position, n, settings);
    const double bounce = std::clamp(0.2 + 0.8 * double(dot(n, flat_sun)), 0.0, 1.0);
    const Vec3 color = terrainColor(*hit, view, kToSun, settings), added = color - terrainColor(*hit, view, kToSun, without);
    expectComponents(added, {material.albedo.x * 0.4 * bounce, material.albedo.y * 0.5 * bounce, material.albedo.z * 0.6 * bounce}, 1e-5);
    bounced += bounce > 0.3;
    const Vec3 reflected = view - n * (2 * dot(view, n));
    const double fresnel = std::clamp(1 + double(dot(view, n)), 0.0, 1.0);
    const double rim = 0.65 * double(material.snow) * std::pow(fresnel, 4) * smoothStepOf(0, 0.6, reflected.y);
    expectComponents(color - terrainColor(*hit, view, kToSun, no_rim), {0.3 * rim, 0.5 * rim, 0.6 * rim}, 1e-5);
    rims += rim > 0.01;
  }
  EXPECT_GT(bounced, 50);
  EXPECT_GT(rims, 10);
}

TEST(Terrain, FogAndScatterAreTheirFormulasAndCanBeLeftOut) {
  const TerrainSettings settings;
  EXPECT_EQ(terrainFog(0, settings), 0);
  EXPECT_NEAR(terrainFog(1000 * kScale, settings), 1 - std::exp(-1), 1e-6);
  EXPECT_NEAR(terrainFog(250 * kScale, settings), 1 - std::exp(-0.125), 1e-6);
  EXPECT_NEAR(terrainFog(4000 * kScale, settings), 1 - std::exp(-8), 1e-6);
  TerrainSettings bare = settings;
  bare.use_own_fog = bare.use_sun_scatter = false;
  TerrainSettings scatter = bare;
  scatter.use_sun_scatter = true;
  const Vec3 view = unit(kToSun + Vec3{0.2F, -0.55F, 0.1F});
  const TerrainHit hit{500 * kScale, {5000, 6000, 7000}};
  const Vec3 color = terrainColor(hit, view, kToSun, bare), foggy = terrainColor(hit, view, kToSun, settings);
  const double fog = terrainFog(hit.distance, settings), s8 = std::pow(double(dot(view, kToSun)), 8);
  ASSERT_GT(s8, 0.05);
  expectComponents(foggy,
                   {color.x + (0.65 * 0.4 - color.x) * fog + 0.3 * s8, color.y + (0.65 * 0.65 - color.y) * fog + 0.21 * s8,
                    color.z + (0.65 - color.z) * fog + 0.09 * s8},
                   1e-5);
  expectComponents(terrainColor(hit, view, kToSun, scatter) - color, {0.3 * s8, 0.21 * s8, 0.09 * s8}, 1e-5);
}

TEST(Terrain, SkyHasItsConstants) {
  TerrainSettings settings;
  settings.use_sun_scatter = false;
  settings.sky.cloud = {};
  TerrainSettings clear = settings;
  clear.sky.cloud_height = -1;  // under the viewer: no clouds
  const auto by_hand = [](Vec3 view, Vec3 sun) {
    const double y = std::max(0.0, double(view.y)), s = std::max(0.0, double(dot(view, sun)));
    const double base[]{.3, .5, .85}, haze[]{.7, .75, .85}, wide[]{1, .7, .4}, narrow[]{1, .8, .6}, horizon[]{.4, .65, 1};
    std::array<double, 3> color;
    for (int c = 0; c < 3; ++c) {
      double value = base[c] - 0.5 * double(view.y) * double(view.y);
      value += (0.85 * haze[c] - value) * std::pow(1 - y, 4);
      value += 0.25 * wide[c] * std::pow(s, 5) + 0.25 * narrow[c] * std::pow(s, 64) + 0.2 * narrow[c] * std::pow(s, 512);
      value += (0.68 * horizon[c] - value) * std::pow(1 - y, 16);
      color[size_t(c)] = std::max(0.0, value);
    }
    return color;
  };
  for (float azimuth = 0; azimuth < 360; azimuth += 24)
    for (const float elevation : {-90.0F, -10.0F, 0.0F, 2.0F, 10.0F, 25.09F, 45.0F, 90.0F}) {
      const Vec3 view = directionFromAngles(azimuth, elevation);
      expectComponents(terrainSky({0, 5000, 0}, view, kToSun, clear), by_hand(view, kToSun), 2e-5);
    }
  for (const double degrees : {0.0, 2.0, 6.0, 20.0}) {
    const Vec3 view = unit(kToSun + Vec3{0, float(std::tan(degrees * kPi / 180)), 0});
    expectComponents(terrainSky({0, 5000, 0}, view, kToSun, clear), by_hand(view, kToSun), 1e-4);
  }
  // Level: the horizon's colour alone.
  expectComponents(terrainSky({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, clear), {0.68 * 0.4, 0.68 * 0.65, 0.68}, 1e-6);
  // Scattering: .3(1, .7, .3)·s⁸.
  clear.use_sun_scatter = true;
  const std::array<double, 3> at_sun = by_hand(kToSun, kToSun);
  expectComponents(terrainSky({0, 5000, 0}, kToSun, kToSun, clear), {at_sun[0] + 0.3, at_sun[1] + 0.21, at_sun[2] + 0.09}, 1e-4);
}

TEST(Terrain, SkysCloudsLieOnTheirPlane) {
  TerrainSettings settings;
  settings.use_sun_scatter = false;
  TerrainSettings clear = settings;
  clear.sky.cloud_height = -1;
  int clouds = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3 position{float(2e5 * draw(i, 0)), float(2e4 * draw(i, 1)), float(2e5 * draw(i, 2))};
    const Vec3 view = directionFromAngles(float(360 * draw(i, 3)), float(10 + 80 * draw(i, 4))), to_sun = -view;
    const double t = (1000 * kScale - position.y) / view.y;
    const double x = position.x + t * view.x, z = position.z + t * view.z;
    const double fbm = terrainFbm({float(0.0005 * x / kScale), float(0.0005 * z / kScale)}, 0x3C6EF372);
    const double mix = 0.5 * smoothStepOf(0.5, 0.8, fbm) * (1 - std::pow(1 - double(view.y), 16));
    const Vec3 without = terrainSky(position, view, to_sun, clear);
    const double before[]{0.3 - 0.5 * double(view.y) * view.y, 0.5 - 0.5 * double(view.y) * view.y, 0.85 - 0.5 * double(view.y) * view.y};
    if (without.x == 0) continue;  // not clamped
    const double haze = std::pow(1 - double(view.y), 4);
    const double red = before[0] + (0.85 * 0.7 - before[0]) * haze, blue = before[2] + (0.85 * 0.85 - before[2]) * haze;
    const Vec3 with = terrainSky(position, view, to_sun, settings);
    EXPECT_NEAR(with.x - without.x, mix * (1 - red), 2e-3);
    EXPECT_NEAR(with.z - without.z, mix * (1 - blue), 2e-3);
    clouds += mix > 0.05;
    // From above the plane there are none.
    const Vec3 high{position.x, float(1001 * kScale), position.z};
    EXPECT_EQ(terrainSky(high, view, to_sun, settings), terrainSky(high, view, to_sun, clear));
  }
  EXPECT_GT(clouds, 50);
}

TEST(Terrain, CameraFollowsItsPath) {
  const TerrainSettings settings;
  for (const double seconds : {0.0, 1.0 / 24, 10.0, 77.0, 1234.5}) {
    const double t = 0.1 * seconds, radius = 1100 * kScale;
    const TerrainCamera camera = terrainPath(seconds, settings);
    const double x = radius * std::cos(0.23 * t), z = radius * std::cos(1.5 + 0.21 * t);
    const double y = heightByHand(x, z, 3) + 22 * kScale;
    expectComponents(camera.position, {x, y, z}, 0.1, "position");
    expectComponents(camera.target, {radius * std::cos(0.23 * (t + 3)), y - 20 * kScale, radius * std::cos(1.5 + 0.21 * (t + 3))}, 0.1,
                     "target");
    EXPECT_NEAR(camera.roll_radians, 0.2 * std::cos(0.1 * t), 1e-6);
    EXPECT_EQ(camera.focal_length, 3);
    const Camera rolled = cameraOf(camera, 64, 36);
    EXPECT_EQ(rolled.look_from, camera.position);
    EXPECT_EQ(rolled.look_at, camera.target);
    EXPECT_EQ(rolled.roll_radians, camera.roll_radians);
    // Focal length 3: the top of the picture lies 1/3 above its centre.
    const Vec3 forward = cameraAxes(rolled).forward;
    EXPECT_NEAR(std::tan(angleDegrees(cameraRay(rolled, 32, 0).direction, forward) * kPi / 180), 1.0 / 3, 1e-4);
  }
}

TEST(Terrain, PictureIsOfItsSamples) {
  TerrainSettings settings;
  const Camera camera = cameraOf(terrainPath(30, settings), 24, 14);
  const Layer one = renderTerrain(camera, kToSun, settings);
  settings.samples_per_side = 2;
  const Layer four = renderTerrain(camera, kToSun, settings);
  int covered = 0, partly = 0, blank = 0;
  for (int y = 0; y < 14; ++y)
    for (int x = 0; x < 24; ++x) {
      const Ray ray = cameraRay(camera, float(x) + 0.5F, float(y) + 0.5F);
      const auto hit = marchTerrain(ray, settings);
      const LayerPixel& pixel = one.at(x, y);
      ASSERT_EQ(pixel.opacity, hit ? 1 : 0);
      if (hit) {
        EXPECT_EQ(pixel.color, terrainColor(*hit, ray.direction, kToSun, settings));
        EXPECT_EQ(pixel.distance, float(hit->distance));
      } else {
        EXPECT_EQ(pixel.distance, INFINITY);
      }
      int hits = 0;
      for (int i = 0; i < 4; ++i) {
        const Vec2 place = pixelPlaces(2)[size_t(i)];
        const Ray sample = cameraRay(camera, float(x) + place.x, float(y) + place.y);
        const auto sample_hit = marchTerrain(sample, settings);
        const LayerPixel& found = four.at(x, y, i);
        ASSERT_EQ(found.opacity, sample_hit ? 1 : 0);
        if (!sample_hit) continue;
        EXPECT_EQ(found.color, terrainColor(*sample_hit, sample.direction, kToSun, settings));
        EXPECT_EQ(found.distance, float(sample_hit->distance));
        ++hits;
      }
      covered += hits == 4;
      partly += hits > 0 && hits < 4;
      blank += hits == 0;
    }
  EXPECT_GT(covered, 100);
  EXPECT_GT(partly, 3);
  EXPECT_GT(blank, 30);
}

TEST(Terrain, IsTheSameForAnyNumberOfThreads) {
  const TerrainSettings settings;
  const Camera camera = cameraOf(terrainPath(30, settings), 37, 23);
  const auto render = [&](size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return std::pair{renderTerrain(camera, kToSun, settings), renderTerrainSky(camera, kToSun, settings)};
  };
  const auto one = render(1), seven = render(7);
  EXPECT_EQ(std::memcmp(one.first.pixels.data(), seven.first.pixels.data(), one.first.pixels.size() * sizeof(LayerPixel)), 0);
  EXPECT_EQ(std::memcmp(one.second.pixels.data(), seven.second.pixels.data(), one.second.pixels.size() * sizeof(Vec3)), 0);
  EXPECT_EQ(one.second.at(5, 3), terrainSky(camera.look_from, cameraRay(camera, 5.5F, 3.5F).direction, kToSun, settings));
}

TEST(Terrain, IsFiniteAndNotNegativeEverywhere) {
  const TerrainSettings settings;
  const TerrainCamera path = terrainPath(1e15, settings);
  EXPECT_TRUE(isFinite(path.position) && isFinite(path.target) && std::isfinite(path.roll_radians));
  const Vec3 ground{0, float(terrainHeight(0, 0, 9, settings)), 0};
  const Vec3 places[]{path.position, ground, ground - Vec3{0, 20000, 0}, {0, 1e6F, 0}, {0, 1e9F, 3e9F}, {1e20F, 3e4F, -1e20F}};
  int hits = 0, under_ground = 0;
  for (const Vec3 place : places)
    for (const Vec3 to_sun : {kToSun, Vec3{0, 1, 0}, Vec3{0, -1, 0}, unit({1, -0.1F, 0}), Vec3{0, 0, 1}})
      for (float azimuth = 0; azimuth < 360; azimuth += 45)
        for (const float elevation : {-90.0F, -40.0F, -0.001F, 0.0F, 1e-6F, 30.0F, 90.0F}) {
          const Vec3 view = directionFromAngles(azimuth, elevation);
          const Vec3 sky = terrainSky(place, view, to_sun, settings);
          ASSERT_TRUE(isFinite(sky) && std::min({sky.x, sky.y, sky.z}) >= 0);
          const auto hit = marchTerrain({place, view}, settings);
          under_ground += hit && place == places[2] && hit->distance < 2;
          if (!hit) continue;
          const Vec3 color = terrainColor(*hit, view, to_sun, settings);
          ASSERT_TRUE(isFinite(color) && std::min({color.x, color.y, color.z}) >= 0) << place.x << " " << azimuth << " " << elevation;
          ++hits;
        }
  EXPECT_GT(hits, 500);
  EXPECT_EQ(under_ground, 5 * 8 * 7);  // seen at once
}

TEST(Terrain, ShadowsOtherThings) {
  const TerrainSettings settings;
  std::vector<Vec3> points;
  for (int i = 0; i < 60; ++i) {
    const int row = i / 12;
    const float x = 3000.0F * float(i % 12), z = 7000.0F * float(row);
    points.push_back({x, float(terrainHeight(x, z, 9, settings)) + 600.0F * float(i % 5), z});
  }
  points.push_back({0, 1e6F, 0});
  const Vec3 low = directionFromAngles(70, 6);
  std::vector<float> shares(points.size(), 0.5F), set(points.size(), 1);
  passTerrain(points, low, settings, shares);
  int dark = 0, lit = 0;
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    EXPECT_NEAR(shares[i], 0.5F * terrainShadow(points[i], low, settings), 1e-6);
    dark += shares[i]<0.1F, lit += shares[i]> 0.4F;
  }
  EXPECT_TRUE(dark > 5 && lit > 5) << dark << " " << lit;
  EXPECT_EQ(shares.back(), 0.5F);
  // A sun that has just set still lights what is high.
  passTerrain(points, directionFromAngles(70, -4), settings, set);
  EXPECT_EQ(set.back(), 1);
  EXPECT_EQ(set[0], terrainShadow(points[0], directionFromAngles(70, 0), settings));
}

// Other things take their part of the sun from the ground, and of the sun alone.
TEST(Terrain, LiesInTheShadowOfOtherThings) {
  const TerrainSettings settings;
  const Camera camera = cameraOf(terrainPath(30, settings), 24, 14);
  const auto half = [](std::span<const Vec3>, std::span<float> shares) {
    for (float& share : shares) share *= 0.5F;
  };
  const auto none = [](std::span<const Vec3>, std::span<float> shares) { std::fill(shares.begin(), shares.end(), 0.0F); };
  TerrainSettings no_sun = settings;
  no_sun.light.sun = no_sun.light.specular = {};
  const Layer plain = renderTerrain(camera, kToSun, settings), partly = renderTerrain(camera, kToSun, settings, half),
              dark = renderTerrain(camera, kToSun, settings, none), without = renderTerrain(camera, kToSun, no_sun);
  int darker = 0;
  for (size_t i = 0; i < plain.pixels.size(); ++i) {
    EXPECT_EQ(plain.pixels[i].distance, dark.pixels[i].distance);
    EXPECT_LT(length(dark.pixels[i].color - without.pixels[i].color), 1e-6F);
    darker += partly.pixels[i].color.x < 0.98F * plain.pixels[i].color.x && partly.pixels[i].color.x > 1.02F * dark.pixels[i].color.x;
  }
  EXPECT_GT(darker, 30);
}

}  // namespace
}  // namespace cloudbake
