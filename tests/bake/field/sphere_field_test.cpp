#include "bake/field/sphere_field.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/random.h"

using namespace cloudbake;

namespace {

constexpr float kBand = 3;

const std::vector<IndexSphere> kIndexCluster{{{0, 0, 0}, 25}, {{22, 7, 0}, 17}, {{-17, 10, 12}, 15}, {{2, 22, -5}, 12}, {{3, -20, 4}, 14}};

// 0.9 of the steepest noise that is allowed.
SphereField noisyField(float k = 0, std::optional<float> base = std::nullopt, int octaves = 3, float size = 16) {
  SphereField field{.band_voxels = kBand, .k_voxels = k, .base_voxels = base, .base_k_voxels = k};
  field.noise = BillowNoise{.amplitude = 0.9F * size / float(billowSlope(octaves)), .size = size, .octaves = octaves};
  field.steepest = 1.9F;
  return field;
}

std::vector<SphereField> fields() {
  return {noisyField(),
          noisyField(2),
          noisyField(2, -12.3F),
          noisyField(0, -12.3F),
          noisyField(0, std::nullopt, 1, 8),
          noisyField(1, std::nullopt, 1, 30)};
}

// Bases with bumps of 0.9 of the steepest that is allowed, with noise and without it, sharp and soft.
std::vector<SphereField> bumpyBases() {
  std::vector<SphereField> all;
  for (SphereField field : {noisyField(0, -12.3F), noisyField(2, -12.3F), SphereField{.band_voxels = kBand, .base_voxels = -5.0F}}) {
    field.base_bumps = BillowNoise{.amplitude = 0.9F * 12 / float(billowSlope(2)), .size = 12, .octaves = 2, .seed = 4};
    field.steepest = 1.9F;
    all.push_back(field);
    field.base_k_voxels = 6;
    all.push_back(field);
  }
  return all;
}

float spherePhiAt(Vec3 x, const SphereField& field, std::span<const IndexSphere> spheres = kIndexCluster) {
  std::vector<float> distances(spheres.size());
  return sphereFieldAt(x, spheres, distances, field);
}

SphereField withoutNoise(SphereField field) {
  field.noise.reset();
  field.steepest = 1;
  return field;
}

Vec3 pointWithin(uint32_t n, float reach) {
  const auto coordinate = [&](uint32_t axis) { return reach * (2 * uniformFloat(hashDraw(5, n, axis)) - 1); };
  return {coordinate(0), coordinate(1), coordinate(2)};
}

Vec3 randomDirection(uint32_t n) { return *normalized(pointWithin(n + 0x40000000, 1)); }

}  // namespace

// What is inside stays inside, and what is farther out than the amplitude stays outside. Both ends are nearly reached.
TEST(SphereField, NoisePushesOutwardsUpToItsAmplitude) {
  for (const SphereField& field : fields()) {
    float lowest = 0, highest = -INFINITY;  // φ without noise where noise makes inside of it; where it does not
    for (uint32_t n = 0; n < 200000; ++n) {
      const Vec3 x = pointWithin(n, 45);
      const float smooth = spherePhiAt(x, withoutNoise(field)), bumpy = spherePhiAt(x, field);
      if (smooth <= 0) {
        ASSERT_LE(bumpy, 0);
      }
      if (bumpy <= 0)
        highest = std::max(highest, smooth);
      else
        lowest = lowest == 0 ? smooth : std::min(lowest, smooth);
    }
    const float amplitude = field.noise->amplitude;
    EXPECT_LT(highest, amplitude);
    EXPECT_GT(highest, 0.75F * amplitude);
    EXPECT_LT(lowest, 0.4F * amplitude);
  }
}

// The surface lies where (union − amplitude · n), then the smooth maximum with the base, is 0: by hand for one ball.
TEST(SphereField, SurfaceIsWhereTheNoiseSays) {
  const std::vector<IndexSphere> ball{{{0, 0, 0}, 25}};
  const SphereField field = noisyField();
  for (uint32_t n = 0; n < 2000; ++n) {
    const Vec3 u = randomDirection(n);
    float low = 25, high = 25 + field.noise->amplitude;
    for (int step = 0; step < 20; ++step) (spherePhiAt(0.5F * (low + high) * u, field, ball) < 0 ? low : high) = 0.5F * (low + high);
    EXPECT_NEAR(low - 25, field.noise->amplitude * billow(low / field.noise->size * u, 3, 1).value, 1e-3);
  }
}

// Near the surface φ is as steep as a distance, or a little less where a crease rounds it.
TEST(SphereField, NoiseIsNormalised) {
  const float h = 0.05F;
  for (const SphereField& field : fields()) {
    int near = 0, steep = 0, flat = 0;
    for (uint32_t n = 0; n < 400000; ++n) {
      const Vec3 x = pointWithin(n, 45);
      if (std::fabs(spherePhiAt(x, field)) > 0.5F) continue;
      ++near;
      const Vec3 gradient{spherePhiAt(x + Vec3{h, 0, 0}, field) - spherePhiAt(x - Vec3{h, 0, 0}, field),
                          spherePhiAt(x + Vec3{0, h, 0}, field) - spherePhiAt(x - Vec3{0, h, 0}, field),
                          spherePhiAt(x + Vec3{0, 0, h}, field) - spherePhiAt(x - Vec3{0, 0, h}, field)};
      const float slope = length(gradient) / (2 * h);
      steep += slope > 1.1F;
      flat += slope < 0.6F;
    }
    EXPECT_GT(near, 5000);
    EXPECT_LT(steep, 0.04 * near);
    EXPECT_LT(flat, 0.04 * near);
  }
}

// Marchers step by 0.9 |φ|: nowhere is the surface nearer than |φ| / steepest, and only beside creases nearer than 0.9 |φ|.
TEST(SphereField, MarchersRarelyStepTooFar) {
  for (const SphereField& field : fields()) {
    int points = 0, stepped_over = 0;
    for (uint32_t n = 0; n < 100000; ++n) {
      const Vec3 x = pointWithin(n, 45);
      const float phi = spherePhiAt(x, field);
      if (std::fabs(phi) >= kBand) continue;
      ++points;
      bool crosses = false;
      for (uint32_t ray = 0; ray < 50; ++ray) {
        const Vec3 step = std::fabs(phi) * randomDirection(n * 64 + ray);
        ASSERT_GE(spherePhiAt(x + step * (0.999F / field.steepest), field) * phi, 0);
        crosses = crosses || spherePhiAt(x + 0.9F * step, field) * phi < 0;
      }
      stepped_over += crosses;
    }
    EXPECT_LT(stepped_over, 0.04 * points);
  }
}

// A block that is left out holds no voxel of the band, and the spheres that are left out of one change nothing in it.
TEST(SphereField, BlocksAndSpheresThatAreLeftOutDoNotMatter) {
  const float radius = 6.1F;
  std::vector<SphereField> all = fields();
  all.push_back(withoutNoise(all[2]));
  for (const SphereField& field : bumpyBases()) all.push_back(field);
  for (const SphereField& field : all) {
    int left_out = 0, fewer = 0;
    for (uint32_t n = 0; n < 3000; ++n) {
      const Vec3 center = pointWithin(n, 60);
      const std::vector<IndexSphere> near = spheresNear(center, radius, kIndexCluster, field);
      std::vector<float> distances(kIndexCluster.size());
      const bool beyond = near.empty() || isBeyondBand(center, radius, kIndexCluster, distances, field);
      left_out += beyond;
      fewer += !beyond && near.size() < kIndexCluster.size();
      for (uint32_t sample = 0; sample < 200; ++sample) {
        const Vec3 x = center + radius * uniformFloat(hashDraw(9, n, sample)) * randomDirection(n * 256 + sample);
        const float phi = spherePhiAt(x, field);
        if (beyond) {
          ASSERT_GE(std::fabs(phi), kBand);
        } else if (std::fabs(phi) < kBand) {
          ASSERT_NEAR(spherePhiAt(x, field, near), phi, 1e-4);
        }
      }
    }
    EXPECT_GT(left_out, 1000);
    EXPECT_GT(fewer, 100);
  }
}

// Away from the rim the base is the plane.
TEST(SphereField, BaseStaysFlat) {
  for (const float k : {0.0F, 1.0F, 4.0F}) {
    const SphereField field = noisyField(k, -3.0F);
    for (uint32_t n = 0; n < 20000; ++n) {
      const Vec3 x = pointWithin(n, 40), on_base{x.x, -3, x.z};
      SphereField no_base = withoutNoise(field);
      no_base.base_voxels.reset();
      if (spherePhiAt(on_base, no_base) > -4 - 5 * k) continue;
      EXPECT_LT(spherePhiAt(on_base + Vec3{0, 0.05F, 0}, field), 0) << k;
      EXPECT_GT(spherePhiAt(on_base - Vec3{0, 0.05F, 0}, field), 0) << k;
    }
  }
}

// Bumps hang down from the base by up to their height, which is nearly reached, and the same above every point of the ground.
TEST(SphereField, BumpsHangFromTheBase) {
  const std::vector<IndexSphere> ball{{{0, 0, 0}, 60}};
  SphereField field{.band_voxels = kBand, .base_voxels = -10.0F};
  field.base_bumps = BillowNoise{.amplitude = 4, .size = 15, .octaves = 2};
  field.steepest = float(1 + 4 / 15.0 * billowSlope(2));
  float lowest = 0, highest = -INFINITY;
  for (uint32_t n = 0; n < 20000; ++n) {
    const Vec3 x = pointWithin(n, 30), on_ground{x.x, 0, x.z};
    const float base = -10 - 4 * billow(on_ground / 15, 2, 1).value;
    EXPECT_LT(spherePhiAt({x.x, base + 0.1F, x.z}, field, ball), 0);
    EXPECT_GT(spherePhiAt({x.x, base - 0.1F, x.z}, field, ball), 0);
    lowest = std::min(lowest, base), highest = std::max(highest, base);
  }
  EXPECT_LT(lowest, -13.3F);
  EXPECT_GE(lowest, -14);
  EXPECT_GT(highest, -12);
}

// The rim of a soft base is cut by k ln 2 where plane and ball meet; the middle stays in the plane.
TEST(SphereField, ASoftBaseRoundsItsRim) {
  const std::vector<IndexSphere> ball{{{0, 0, 0}, 60}};
  const SphereField sharp{.band_voxels = kBand, .base_voxels = 0.0F}, soft{.band_voxels = kBand, .base_voxels = 0.0F, .base_k_voxels = 3};
  EXPECT_NEAR(spherePhiAt({60, 0, 0}, sharp, ball), 0, 1e-4);
  EXPECT_NEAR(spherePhiAt({60, 0, 0}, soft, ball), 3 * std::log(2.0F), 1e-4);
  EXPECT_NEAR(spherePhiAt({5, 0, 0}, soft, ball), 0, 1e-4);
}
