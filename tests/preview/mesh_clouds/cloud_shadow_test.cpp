// Shadows of a ball, whose chords are known, and of one of its copies by a lattice.
#include "preview/mesh_clouds/cloud_shadow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "core/types.h"
#include "preview/camera.h"

namespace cloudbake {
namespace {

constexpr int kCells = 48;
constexpr float kSigma = 1.3F;

// A ball of radius 1 about (0.2, −0.1, 0.4) in cells with the mean over 4 × 4 × 4 points.
const Vec3 kCenter{0.2F, -0.1F, 0.4F};
ShadowCaster ballCaster() {
  ShadowCaster caster;
  caster.cell_size = 2.2F / kCells;
  caster.cells = {kCells, kCells + 3, kCells - 1};
  caster.origin = kCenter - Vec3{1.1F, 1.13F, 1.07F};
  for (int k = 0; k < caster.cells[2]; ++k)
    for (int j = 0; j < caster.cells[1]; ++j)
      for (int i = 0; i < caster.cells[0]; ++i) {
        int inside = 0;
        for (int s = 0; s < 64; ++s) {
          const int row = s / 4 % 4, slice = s / 16;
          const Vec3 at{float(i) + float(s % 4) / 4 - 0.375F, float(j) + float(row) / 4 - 0.375F, float(k) + float(slice) / 4 - 0.375F};
          inside += length(caster.origin + at * caster.cell_size - kCenter) < 1;
        }
        caster.fractions.push_back(uint8_t(std::lround(255.0 * inside / 64)));
      }
  return caster;
}

// The part of the ball before a point, towards the light.
double chordBefore(Vec3 point, Vec3 to_light) {
  const Vec3 p = point - kCenter;
  const double b = dot(p, to_light), c = double(dot(p, p)) - 1, discriminant = b * b - c;
  if (discriminant <= 0) return 0;
  const double enter = -b - std::sqrt(discriminant), leave = -b + std::sqrt(discriminant);
  return std::max(0.0, leave) - std::max(0.0, enter);
}

const Vec3 kLights[]{directionFromAngles(30, 60), directionFromAngles(-100, 20), directionFromAngles(200, 5),
                     directionFromAngles(0, 90),  directionFromAngles(90, 0),    directionFromAngles(77, -35)};

TEST(CloudShadow, BehindABallIsItsChord) {
  const ShadowCaster caster = ballCaster();
  for (const Vec3& light : kLights) {
    const CloudShadow shadow(caster, {}, kSigma, light, {.softness_degrees = 0});
    const Frame frame = frameAround(light);
    double worst = 0, sum = 0;
    int inside = 0;
    for (const float behind : {1.5F, 4.0F, 60.0F})
      for (float u = -1.4F; u < 1.4F; u += 0.05F)
        for (float v = -1.4F; v < 1.4F; v += 0.05F) {
          const Vec3 point = kCenter - light * behind + frame.tangent * u + frame.bitangent * v;
          const double exact = std::exp(-kSigma * chordBefore(point, light)), share = shadow.shareAt(point);
          ASSERT_TRUE(u * u + v * v < 1.15 * 1.15 || share > 0.999) << share;
          if (u * u + v * v < 0.9 * 0.9) worst = std::max(worst, std::abs(share - exact)), sum += share - exact, ++inside;
        }
    EXPECT_LT(worst, 0.09);
    EXPECT_LT(std::abs(sum / inside), 0.005);
    // Before the ball the light is whole.
    for (float u = -1; u < 1; u += 0.1F) EXPECT_EQ(shadow.shareAt(kCenter + light * 2 + frame.tangent * u), 1);
  }
}

TEST(CloudShadow, WithinTheCloudThePartBeforeCounts) {
  const ShadowCaster caster = ballCaster();
  const Vec3 up{0, 1, 0};
  const CloudShadow shadow(caster, {}, kSigma, up, {.softness_degrees = 0});
  float last = 1;
  for (float depth = -1; depth <= 1; depth += 0.1F) {
    const float share = shadow.shareAt(kCenter - up * depth);
    EXPECT_NEAR(share, std::exp(-kSigma * (1 + depth)), 0.06F) << depth;
    EXPECT_LE(share, last);
    last = share;
  }
}

// Under a transform the shadow is that of the transformed ball: chords come from the ball's own space.
TEST(CloudShadow, MovesTurnsAndStretchesWithItsCloud) {
  const ShadowCaster caster = ballCaster();
  Affine stretched;
  stretched.linear = {{{0, 0, 3}, {-2, 0, 0}, {0, 5, 0}}};
  stretched.offset = {10, -20, 30};
  const Affine to_own = inverted(stretched).value();
  for (const Vec3& light : kLights) {
    const CloudShadow shadow(caster, stretched, 0.3F, light, {.softness_degrees = 0});
    const Vec3 own_light = transformVector(to_own, light), center = transformPoint(stretched, kCenter);
    const Frame frame = frameAround(light);
    double sum = 0;
    int count = 0, shaded = 0;
    for (float u = -6; u < 6; u += 0.2F)
      for (float v = -6; v < 6; v += 0.2F) {
        const Vec3 point = center - light * 20 + frame.tangent * u + frame.bitangent * v;
        // A length along the light in the ball's space is longer there by ‖M⁻¹ l‖.
        const double chord = chordBefore(transformPoint(to_own, point), *normalized(own_light)) / length(own_light);
        const double difference = shadow.shareAt(point) - std::exp(-0.3 * chord);
        sum += std::abs(difference), ++count;
        if (!(chord > 2)) continue;
        EXPECT_LT(std::abs(difference), 0.1) << u << " " << v;
        ++shaded;
      }
    EXPECT_LT(sum / count, 0.004);
    EXPECT_GT(shaded, 200);
  }
}

// A softer light spreads the same shadow wider with the distance: what is absorbed over a plane stays, the middle becomes lighter.
TEST(CloudShadow, IsSofterFartherAway) {
  const ShadowCaster caster = ballCaster();
  const Vec3 light = directionFromAngles(20, 65);
  const Frame frame = frameAround(light);
  const CloudShadow sharp(caster, {}, kSigma, light, {.softness_degrees = 0}), soft(caster, {}, kSigma, light, {.softness_degrees = 5});
  const auto absorbed = [&](const CloudShadow& shadow, float behind, double& middle, double& reach) {
    double sum = 0;
    reach = 0;
    for (float u = -6; u < 6; u += 0.05F)
      for (float v = -6; v < 6; v += 0.05F) {
        const double taken = 1 - shadow.shareAt(kCenter - light * behind + frame.tangent * u + frame.bitangent * v);
        sum += taken * 0.05 * 0.05;
        if (taken > 0.001) reach = std::max(reach, double(std::hypot(u, v)));
      }
    middle = 1 - shadow.shareAt(kCenter - light * behind);
    return sum;
  };
  double middle = 0, reach = 0, last_middle = 2, last_reach = 0;
  const double all = absorbed(sharp, 3, middle, reach);
  for (const float behind : {3.0F, 12.0F, 30.0F}) {
    EXPECT_NEAR(absorbed(soft, behind, middle, reach), all, 0.01 * all) << behind;
    EXPECT_LT(middle, last_middle);
    EXPECT_GT(reach, last_reach);
    last_middle = middle, last_reach = reach;
  }
  // 30 behind, an edge is spread by 30 tan 5° = 2.6 to both sides, in the lattice's axes.
  EXPECT_NEAR(reach, 1 + 2.6, 1.2);
  // Brute force: the mean over a square of that half width about a point, of a sharp shadow.
  const Vec3 point = kCenter - light * 12 + frame.tangent * 0.8F;
  double mean = 0;
  int count = 0;
  const auto half = float(12 * std::tan(5 * kPi / 180));
  for (float u = -half; u < half; u += half / 40)
    for (float v = -half; v < half; v += half / 40) mean += sharp.shareAt(point + Vec3{u, 0, v}), ++count;
  EXPECT_NEAR(soft.shareAt(point), mean / count, 0.08);
}

TEST(CloudShadow, StrengthAndExtinction) {
  const ShadowCaster caster = ballCaster();
  const Vec3 light{0, 1, 0}, below = kCenter - light * 5;
  EXPECT_NEAR(CloudShadow(caster, {}, kSigma, light, {}).shareAt(below), std::exp(-2 * kSigma), 0.01);
  EXPECT_NEAR(CloudShadow(caster, {}, kSigma, light, {.strength = 0.5F}).shareAt(below), 0.5 + 0.5 * std::exp(-2 * kSigma), 0.01);
  EXPECT_EQ(CloudShadow(caster, {}, kSigma, light, {.strength = 0}).shareAt(below), 1);
  EXPECT_NEAR(CloudShadow(caster, {}, 0.01F, light, {}).shareAt(below), std::exp(-0.02), 1e-3);
  EXPECT_NEAR(CloudShadow(caster, {}, 1e6F, light, {}).shareAt(below), 0, 1e-6);
}

TEST(CloudShadow, OfASingleCellOrOfNothing) {
  ShadowCaster caster;
  caster.cells = {1, 1, 1};
  caster.cell_size = 1;
  caster.fractions = {255};
  for (const Vec3& light : kLights) {
    const CloudShadow shadow(caster, {}, 1, light, {.softness_degrees = 0});
    const float share = shadow.shareAt(light * -5);
    EXPECT_TRUE(share > 0.1F && share < 0.6F) << share;
    EXPECT_EQ(shadow.shareAt(light * -5 + frameAround(light).tangent * 4), 1);
  }
  caster.fractions = {0};
  EXPECT_EQ(CloudShadow(caster, {}, 1, {0, 1, 0}, {}).shareAt({0, -5, 0}), 1);
}

// Many clouds, placed, turned and stretched at random, some of them mirrored.
struct ManyClouds {
  std::vector<CloudShadow> shadows;
  std::vector<size_t> owners;
  Vec3 to_light;

  ManyClouds(int count, Vec3 light, float softness_degrees) : to_light(light) {
    const ShadowCaster caster = ballCaster();
    for (int i = 0; i < count; ++i) {
      uint32_t drawn = 0;
      const auto draw = [&] { return uniformFloat(hashDraw(mix64(uint64_t(i) + 1), drawn++, 7)); };
      Affine to_world;
      for (auto& row : to_world.linear)
        for (double& value : row) value = double(draw() - 0.5F) * 2;
      for (size_t axis = 0; axis < 3; ++axis) {
        to_world.linear[axis][axis] += 1.5 + double(draw());
        to_world.offset[axis] = 60 * double(draw() - 0.5F);
      }
      shadows.emplace_back(caster, to_world, kSigma, light, ShadowSettings{.softness_degrees = softness_degrees});
      owners.push_back(size_t(3 * i));
    }
  }
};

// Whichever shadows are not asked about would not have changed a bit.
TEST(CloudShadows, AreTheProductOfAllShadows) {
  constexpr int kPoints = 4000;
  std::vector<Vec3> points;
  for (int i = 0; i < kPoints; ++i) {
    const auto draw = [&](uint32_t n) { return uniformFloat(hashDraw(mix64(99), uint32_t(i), n)); };
    const float wide = i % 3 == 0 ? 2000.0F : 80.0F;  // some of them are far away, where edges are soft
    points.push_back({wide * (draw(0) - 0.5F), wide * (draw(1) - 0.5F), wide * (draw(2) - 0.5F)});
  }
  for (const float softness : {0.0F, 0.75F, 8.0F, 45.0F})
    for (const Vec3& light : kLights) {
      const ManyClouds many(40, light, softness);
      std::vector<float> expected(points.size(), 1);
      constexpr size_t kOwner = 3 * 17;
      for (size_t i = 0; i < many.shadows.size(); ++i)
        for (size_t k = 0; k < points.size() && many.owners[i] != kOwner; ++k) expected[k] *= many.shadows[i].shareAt(points[k]);
      const CloudShadows shadows(many.shadows, many.owners, light);
      std::vector<float> shares(points.size(), 1);
      shadows.pass(points, shares, kOwner);
      EXPECT_EQ(shares, expected) << softness;
      const auto dark = std::count_if(shares.begin(), shares.end(), [](float share) { return share < 1; });
      EXPECT_GT(dark, 100) << softness;
    }
}

// Outside of its reach a shadow is nothing, and the reach is no larger than it must be.
TEST(CloudShadows, ReachesAreTight) {
  for (const Vec3& light : kLights) {
    const ManyClouds many(30, light, 0.75F);
    const Frame frame = frameAround(light);
    for (const CloudShadow& shadow : many.shadows) {
      const ShadowReach reach = shadow.reach(light, frame.tangent, frame.bitangent);
      ASSERT_TRUE(std::isfinite(reach.from));
      for (size_t side = 0; side < 2; ++side) {
        EXPECT_LT(reach.high[side] - reach.low[side], 24);  // of a ball that is up to 4.5 times as large, in a turned box
        EXPECT_LT(reach.growth[side], 0.1);
      }
    }
  }
}

TEST(CloudShadows, OfNobodyElse) {
  const ManyClouds one(1, kLights[0], 0.75F);
  const CloudShadows shadows(one.shadows, one.owners, one.to_light);
  EXPECT_FALSE(shadows.anyExceptOf(0));
  EXPECT_TRUE(shadows.anyExceptOf(CloudShadows::kNobody));
  EXPECT_FALSE(CloudShadows().anyExceptOf(0));
  std::vector<float> share{1};
  const Vec3 point{};
  CloudShadows().pass({&point, 1}, share);
  EXPECT_EQ(share[0], 1);
}

}  // namespace
}  // namespace cloudbake
