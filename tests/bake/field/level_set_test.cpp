#include "bake/field/level_set.h"

#include <gtest/gtest.h>
#include <openvdb/tools/Interpolation.h>
#include <tbb/global_control.h>

#include <map>
#include <numeric>
#include <random>

#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/surface.h"
#include "core/error.h"
#include "core/level_set_type.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

float phiAt(const LevelSet& level_set, Vec3 world) {
  const Vec3 p = level_set.frame.toIndex(world);
  return float(openvdb::tools::BoxSampler::sample(level_set.grid->vdb->tree(), openvdb::Vec3d(p.x, p.y, p.z)) * level_set.frame.voxel_size);
}

LevelSet ofSpheres(std::vector<Sphere> spheres, LevelSetSettings settings = {}) {
  Warnings warnings;
  return levelSetFromSpheres(spheres, settings, warnings);
}

const double kUnitBallVolume = 4 * kPi / 3;

const std::vector<Sphere> kCluster{{{0, 0, 0}, 1}, {{0.9F, 0.3F, 0}, 0.7F}, {{-0.7F, 0.4F, 0.5F}, 0.6F}, {{0.1F, 0.9F, -0.2F}, 0.5F}};

LevelSetSettings noisy(float amplitude, float size, int octaves = 3) {
  LevelSetSettings settings;
  settings.noise = BillowNoise{.amplitude = amplitude, .size = size, .octaves = octaves};
  return settings;
}

SurfaceMesh surfaceOf(const LevelSet& level_set) {
  Warnings warnings;
  return meshFromLevelSet(level_set, {}, warnings);
}

// Surfaces that face outwards and hold a tenth of a voxel or more: the parts of a solid. Cavities face inwards.
size_t partsOf(const SurfaceMesh& mesh, double voxel_size) {
  std::vector<uint32_t> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Triangle& t : mesh.triangles)
    for (size_t k = 1; k < 3; ++k) parent[root(t[k])] = root(t[0]);
  std::map<uint32_t, double> volumes;
  for (const Triangle& t : mesh.triangles)
    volumes[root(t[0])] += dot(mesh.positions[t[0]], cross(mesh.positions[t[1]], mesh.positions[t[2]]));
  return size_t(std::count_if(volumes.begin(), volumes.end(),
                              [&](const auto& part) { return part.second / 6 > 0.1 * voxel_size * voxel_size * voxel_size; }));
}

// Every value and state, the tiles too.
void expectSameBits(const LevelSet& a, const LevelSet& b) {
  const auto &one = a.grid->vdb->tree(), &other = b.grid->vdb->tree();
  EXPECT_EQ(one.leafCount(), other.leafCount());
  EXPECT_EQ(one.activeVoxelCount(), other.activeVoxelCount());
  for (auto leaf = one.cbeginLeaf(); leaf; ++leaf)
    for (auto value = leaf->cbeginValueAll(); value; ++value) {
      ASSERT_EQ(*value, other.getValue(value.getCoord()));
      ASSERT_EQ(value.isValueOn(), other.isValueOn(value.getCoord()));
    }
}

std::string refusal(const LevelSetSettings& settings) {
  try {
    ofSpheres(kCluster, settings);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

// φ of one sphere is |x| − R inside the band, clipped beyond it.
TEST(LevelSet, BallIsADistance) {
  const LevelSet ball = ofSpheres({{{0, 0, 0}, 1}});
  const float h = float(ball.frame.voxel_size);
  EXPECT_FLOAT_EQ(h, 0.02F);
  for (const Vec3 direction : {Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{0.6F, 0, 0.8F}})
    for (const float offset : {-2.5F, -1.0F, 0.0F, 1.0F, 2.5F})
      EXPECT_NEAR(phiAt(ball, direction * (1 + offset * h)), offset * h, 0.02 * h);
  EXPECT_FLOAT_EQ(phiAt(ball, {0, 0, 0}), -3 * h);
  EXPECT_FLOAT_EQ(phiAt(ball, {2, 0, 0}), 3 * h);
  EXPECT_NEAR(insideVolume(ball), kUnitBallVolume, 0.01);
}

// With a blend the union is raised by blend/4 where two surfaces are equally far, and the exact union elsewhere.
TEST(LevelSet, BlendRaisesTheCreaseByAQuarter) {
  const std::vector<Sphere> two{{{-0.8F, 0, 0}, 1}, {{0.8F, 0, 0}, 1}};
  LevelSetSettings settings;
  settings.voxels = 200;
  const float crease = 0.6F;  // √(1 − 0.8²)
  EXPECT_NEAR(phiAt(ofSpheres(two, settings), {0, crease, 0}), 0, 0.01);
  settings.blend = 0.08F;
  const LevelSet blended = ofSpheres(two, settings);
  EXPECT_NEAR(phiAt(blended, {0, crease, 0}), -0.02, 0.002);
  EXPECT_NEAR(phiAt(blended, {-1.8F, 0, 0}), 0, 0.001);
}

// N spheres in one place under a blend are a ball too: u = |x| − R − k ln N with k = blend / (4 ln 2). It has grown far beyond the box of
// the spheres, and the grid must hold all of it.
TEST(LevelSet, BlendGrowsACrowdBeyondItsBox) {
  LevelSetSettings settings;
  settings.voxels = 20;
  settings.blend = 0.4F;
  const Vec3 center{0.1F, -0.2F, 0.3F};
  const LevelSet crowd = ofSpheres(std::vector<Sphere>(256, {center, 1}), settings);
  const double radius = 1 + 0.4 / (4 * std::log(2.0)) * std::log(256.0);
  EXPECT_NEAR(radius, 1.8, 1e-9);
  EXPECT_NEAR(insideVolume(crowd) / (kUnitBallVolume * std::pow(radius, 3)), 1, 0.01);
  const SurfaceMesh mesh = surfaceOf(crowd);
  EXPECT_EQ(findDefects(mesh).unmatched_edges, 0U);
  for (const Vec3& p : mesh.positions) ASSERT_NEAR(length(p - center), radius, 0.03 * crowd.frame.voxel_size);
}

// A flat heap of puffs under a blend of a quarter of its width, against the smooth union in double: inside and outside are right at every
// point of a lattice finer than the grid, and within two voxels of the surface φ is that of the formula.
TEST(LevelSet, WideBlendOfManySpheresIsItsFormula) {
  std::vector<Sphere> spheres;
  for (int i = 0; i < 80; ++i) {
    const float turn = 2.39996F * float(i), from_middle = 0.2F * std::sqrt(float(i));
    spheres.push_back({{from_middle * std::cos(turn), 0.1F * float(i % 3), from_middle * std::sin(turn)}, 0.4F + 0.05F * float(i % 5)});
  }
  LevelSetSettings settings;
  settings.voxels = 40;
  settings.blend = 1.2F;
  const LevelSet heap = ofSpheres(spheres, settings);
  const double k = 1.2 / (4 * std::log(2.0));
  const auto h = float(heap.frame.voxel_size);
  size_t wrong = 0, off = 0, inside = 0;
  float highest = 0;
  for (float y = -2.5F; y < 2.7F; y += 0.7F * h)
    for (float x = -4; x < 4; x += 1.7F * h)
      for (float z = -4; z < 4; z += 1.7F * h) {
        double sum = 0;
        for (const Sphere& s : spheres) sum += std::exp((s.radius - double(length(Vec3{x, y, z} - s.center))) / k);
        const double truth = -k * std::log(sum);
        const float phi = phiAt(heap, {x, y, z});
        inside += truth < 0;
        if (truth < 0) highest = std::max(highest, y);
        wrong += std::fabs(truth) > 0.1F * h && (phi < 0) != (truth < 0);
        off += std::fabs(truth) < 2 * h && std::fabs(phi - truth) > 0.1F * h;
      }
  EXPECT_EQ(wrong, 0U);
  EXPECT_EQ(off, 0U);
  EXPECT_GT(inside, 1000U);
  EXPECT_GT(highest, 0.8F + 8 * h) << "the heap has grown by more than the band beyond its spheres";
}

// The order of the spheres and a second copy of all of them in place change little or nothing.
TEST(LevelSet, OrderOfSpheresDoesNotMatter) {
  const std::vector<Sphere> one_way{{{-0.5F, 0, 0}, 1}, {{0.7F, 0.2F, 0}, 0.8F}, {{0, 0.9F, 0.3F}, 0.6F}};
  const std::vector<Sphere> other_way(one_way.rbegin(), one_way.rend());
  LevelSetSettings settings;
  settings.blend = 0.1F;
  const LevelSet a = ofSpheres(one_way, settings), b = ofSpheres(other_way, settings);
  EXPECT_NEAR(insideVolume(a), insideVolume(b), 1e-5);
}

// Coincident spheres count once without a blend: the union of a set with itself.
TEST(LevelSet, CoincidentSpheresAreOne) {
  EXPECT_DOUBLE_EQ(insideVolume(ofSpheres({{{0, 0, 0}, 1}, {{0, 0, 0}, 1}})), insideVolume(ofSpheres({{{0, 0, 0}, 1}})));
}

// A half ball: 2π/3. The plane is at y = 0 and nothing lies under it.
TEST(LevelSet, FlatBaseCutsTheCloud) {
  LevelSetSettings settings;
  settings.flat_base = 0.0F;
  const LevelSet half_ball = ofSpheres({{{0, 0, 0}, 1}}, settings);
  EXPECT_NEAR(insideVolume(half_ball), kUnitBallVolume / 2, 0.02);
  EXPECT_GT(phiAt(half_ball, {0, -0.1F, 0}), 0);
  EXPECT_LT(phiAt(half_ball, {0, 0.1F, 0}), 0);
  settings.flat_base = 2.0F;
  EXPECT_THROW(ofSpheres({{{0, 0, 0}, 1}}, settings), InputError);
}

// Spheres under 1.5 voxels are counted and still there: none is lost in silence.
TEST(LevelSet, SmallSpheresAreReported) {
  Warnings warnings;
  const std::vector<Sphere> spheres{{{0, 0, 0}, 1}, {{1.2F, 0, 0}, 0.02F}, {{-1.2F, 0, 0}, 0.5F}};
  const LevelSet level_set = levelSetFromSpheres(spheres, {}, warnings);
  ASSERT_TRUE(warnings.entries().contains(WarningKind::kSphereTooSmall));
  EXPECT_EQ(warnings.entries().at(WarningKind::kSphereTooSmall).count, 1U);
  EXPECT_LT(phiAt(level_set, {1.2F, 0, 0}), 0.01F);
}

// Scales by powers of two: the same index coordinates, so the same bits.
TEST(LevelSet, PowersOfTwoScaleExactly) {
  const std::vector<Sphere> small{{{0.1F, 0.2F, 0}, 0.7F}, {{-0.4F, 0, 0.3F}, 0.5F}};
  std::vector<Sphere> large = small;
  for (Sphere& s : large) s.center = s.center * 1024, s.radius *= 1024;
  const LevelSet a = ofSpheres(small), b = ofSpheres(large);
  EXPECT_EQ(a.grid->vdb->activeVoxelCount(), b.grid->vdb->activeVoxelCount());
  for (auto value = a.grid->vdb->cbeginValueOn(); value; ++value) ASSERT_EQ(*value, b.grid->vdb->tree().getValue(value.getCoord()));
}

// OpenVDB's transforms throw under 1.4e-5; a frame at voxel size 1 does not.
TEST(LevelSet, WorksAtEverySizeAndPlace) {
  for (const float scale : {1e-6F, 1.0F, 1e6F}) {
    EXPECT_NEAR(insideVolume(ofSpheres({{{0, 0, 0}, scale}})) / std::pow(scale, 3), kUnitBallVolume, 0.01);
    Warnings warnings;
    EXPECT_NEAR(insideVolume(levelSetFromMesh(ballMesh(scale, 4), {}, warnings)) / std::pow(scale, 3), kUnitBallVolume, 0.03);
    EXPECT_TRUE(warnings.empty());
  }
  EXPECT_NEAR(insideVolume(ofSpheres({{{1000, -1000, 1000}, 1}})), kUnitBallVolume, 0.02);
}

// At 1e6 radii from the origin float32 steps are 6 % of a radius: said, not hidden.
TEST(LevelSet, FarAwayIsWarned) {
  for (const Vec3 side : {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}) {
    Warnings near, far;
    const std::vector<Sphere> at_1000{{side * 1000, 1}}, at_million{{side * 1e6F, 1}};
    levelSetFromSpheres(at_1000, {}, near);
    levelSetFromSpheres(at_million, {}, far);
    EXPECT_FALSE(near.entries().contains(WarningKind::kCoarseCoordinates)) << side.x << ' ' << side.y << ' ' << side.z;
    EXPECT_TRUE(far.entries().contains(WarningKind::kCoarseCoordinates)) << side.x << ' ' << side.y << ' ' << side.z;
  }
}

// Bumps of a ball: one closed part that holds the ball, within the amplitude; by the mean of the noise larger.
TEST(LevelSet, NoiseGrowsTheBallOutwards) {
  const float amplitude = 0.08F;
  const SurfaceMesh bumpy = surfaceOf(ofSpheres({{{0, 0, 0}, 1}}, noisy(amplitude, 0.4F)));
  EXPECT_EQ(findDefects(bumpy).unmatched_edges, 0U);
  EXPECT_EQ(partsOf(bumpy, 0.02), 1U);
  float nearest = INFINITY, farthest = 0;
  double mean = 0;
  for (const Vec3 p : bumpy.positions) {
    nearest = std::min(nearest, length(p));
    farthest = std::max(farthest, length(p));
    mean += length(p) / double(bumpy.positions.size());
  }
  EXPECT_GT(nearest, 1 - 1e-3F);
  EXPECT_LT(farthest, 1 + amplitude);
  EXPECT_GT(farthest, 1 + 0.8F * amplitude);
  EXPECT_NEAR(signedVolume(bumpy) / kUnitBallVolume, std::pow(mean, 3), 0.01);
  EXPECT_GT(mean, 1 + 0.4 * amplitude);
  EXPECT_LT(mean, 1 + 0.9 * amplitude);
}

// No voxel is lost, and none is won beyond the amplitude. Near the surface the grid stays a distance.
TEST(LevelSet, NoiseKeepsTheBand) {
  for (const float blend : {0.0F, 0.1F}) {
    LevelSetSettings settings = noisy(0.08F, 0.4F), smooth;
    settings.blend = smooth.blend = blend;
    const LevelSet bumpy = ofSpheres(kCluster, settings);
    const auto& tree = bumpy.grid->vdb->tree();
    const LevelSet before = ofSpheres(kCluster, smooth);
    EXPECT_EQ(bumpy.frame.voxel_size, before.frame.voxel_size);
    for (auto value = before.grid->vdb->cbeginValueAll(); value; ++value)
      if (*value <= 0 && value.isVoxelValue()) {
        ASSERT_LE(tree.getValue(value.getCoord()), 0);
      }
    size_t near = 0, steep = 0;
    for (auto value = bumpy.grid->vdb->cbeginValueOn(); value; ++value) {
      const openvdb::Coord c = value.getCoord();
      if (*value <= 0 && blend == 0) {
        float distance = INFINITY;
        for (const Sphere& s : kCluster)
          distance = std::min(distance, length(bumpy.frame.toWorld({float(c.x()), float(c.y()), float(c.z())}) - s.center) - s.radius);
        ASSERT_LT(distance, 0.08F);
      }
      if (std::fabs(*value) > 1) continue;
      ++near;
      Vec3 gradient;
      for (const auto& [axis, slope] : {std::pair{0, &gradient.x}, {1, &gradient.y}, {2, &gradient.z}}) {
        openvdb::Coord step(0);
        step[axis] = 1;
        *slope = 0.5F * (tree.getValue(c + step) - tree.getValue(c - step));
      }
      steep += length(gradient) > 1.1F;
    }
    EXPECT_GT(near, 10000U);
    EXPECT_LT(double(steep), 0.05 * double(near));
  }
}

// Random clusters with the steepest noise that is allowed: one closed part, as without noise.
TEST(LevelSet, NoBumpComesLoose) {
  std::mt19937 random(3);
  const auto uniform = [&](float low, float high) { return low + (high - low) * float(random()) / float(0xFFFFFFFFU); };
  for (int n = 0; n < 12; ++n) {
    std::vector<Sphere> spheres{{{0, 0, 0}, 1}};
    for (int i = 0; i < 8; ++i) {
      const Sphere at = spheres[random() % spheres.size()];
      const Vec3 away = *normalized({uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)});
      spheres.push_back({at.center + away * at.radius, uniform(0.4F, 0.9F)});
    }
    LevelSetSettings settings = noisy(0, 0.5F, 1 + n % 3);
    settings.noise->amplitude = 0.999F * 0.5F / float(billowSlope(1 + n % 3));
    settings.noise->seed = uint64_t(n);
    settings.voxels = 120;
    const LevelSet level_set = ofSpheres(spheres, settings);
    const SurfaceMesh mesh = surfaceOf(level_set);
    EXPECT_EQ(findDefects(mesh).unmatched_edges, 0U) << n;
    EXPECT_EQ(partsOf(mesh, level_set.frame.voxel_size), 1U) << n;
  }
}

// The base lies in its plane, bumps above it, and its rim has grown.
TEST(LevelSet, NoiseLeavesTheBaseFlat) {
  for (const float blend : {0.0F, 0.05F}) {
    LevelSetSettings settings = noisy(0.08F, 0.4F);
    settings.flat_base = -0.2F;
    settings.blend = blend;
    const LevelSet level_set = ofSpheres({{{0, 0, 0}, 1}}, settings);
    const SurfaceMesh mesh = surfaceOf(level_set);
    size_t on_base = 0;
    for (const Vec3 p : mesh.positions) {
      EXPECT_GT(p.y, -0.2F - 0.5F * float(level_set.frame.voxel_size));
      if (p.y > 0 || std::hypot(p.x, p.z) > 0.85F) continue;
      EXPECT_NEAR(p.y, -0.2F, 0.02 * level_set.frame.voxel_size);
      ++on_base;
    }
    EXPECT_GT(on_base, 1000U);
    EXPECT_GT(boundingBox(mesh).high.y, 1.04F);
  }
}

// Moved by whole numbers and scaled by powers of two together with its noise, a cloud keeps its bits; by other factors, its shape.
TEST(LevelSet, NoiseMovesAndScalesWithTheCloud) {
  const auto transformed = [](float scale, Vec3 shift) {
    std::vector<Sphere> spheres{{{0.125F, 0.25F, 0}, 0.75F}, {{-0.375F, 0, 0.25F}, 0.5F}};
    for (Sphere& s : spheres) s.center = s.center * scale + shift, s.radius *= scale;
    return ofSpheres(spheres, noisy(0.0625F * scale, 0.375F * scale));
  };
  const LevelSet original = transformed(1, {});
  expectSameBits(original, transformed(1024, {}));
  expectSameBits(original, transformed(1, {16, -32, 8}));
  const LevelSet odd = transformed(0.3F, {0.7F, 5, -3});
  EXPECT_NEAR(insideVolume(odd) / std::pow(0.3, 3), insideVolume(original), 1e-3);
  for (const Vec3 p : surfaceOf(original).positions)
    ASSERT_NEAR(phiAt(odd, p * 0.3F + Vec3{0.7F, 5, -3}) / 0.3F, phiAt(original, p), 0.1 * original.frame.voxel_size);
}

// The pattern does not depend on the voxels: surfaces of three resolutions lie within a voxel of the coarser.
TEST(LevelSet, NoiseIsTheSameAtEveryResolution) {
  LevelSetSettings settings = noisy(0.08F, 0.5F);
  settings.voxels = 200;
  const LevelSet fine = ofSpheres(kCluster, settings);
  for (const int voxels : {60, 90, 133}) {
    settings.voxels = voxels;
    const LevelSet coarse = ofSpheres(kCluster, settings);
    EXPECT_NEAR(insideVolume(coarse) / insideVolume(fine), 1, 0.01);
    double off = 0, worst = 0;
    const SurfaceMesh mesh = surfaceOf(coarse);
    for (const Vec3 p : mesh.positions) {
      const double distance = std::fabs(phiAt(fine, p));
      off += distance / double(mesh.positions.size());
      worst = std::max(worst, distance);
    }
    EXPECT_LT(worst, coarse.frame.voxel_size) << voxels;
    EXPECT_LT(off, 0.1 * coarse.frame.voxel_size) << voxels;
  }
}

TEST(LevelSet, NoiseIsTheSameForAnyThreads) {
  LevelSetSettings settings = noisy(0.08F, 0.4F);
  settings.blend = 0.1F;
  settings.flat_base = -0.3F;
  std::vector<LevelSet> results;
  for (const size_t threads : {1, 2, 7}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(ofSpheres(kCluster, settings));
  }
  expectSameBits(results[0], results[1]);
  expectSameBits(results[0], results[2]);
}

// An amplitude of 0 is no noise, whatever its size; another seed is another cloud.
TEST(LevelSet, NoiseOfNothingIsNone) {
  for (const float size : {0.0F, 0.4F}) {
    LevelSetSettings none, nothing = noisy(0, size);
    none.blend = nothing.blend = 0.1F;
    expectSameBits(ofSpheres(kCluster, none), ofSpheres(kCluster, nothing));
  }
  LevelSetSettings other = noisy(0.08F, 0.4F);
  other.noise->seed = 2;
  EXPECT_NE(insideVolume(ofSpheres(kCluster, noisy(0.08F, 0.4F))), insideVolume(ofSpheres(kCluster, other)));
}

TEST(LevelSet, RefusesNoiseThatCannotBe) {
  for (const int octaves : {1, 3, 8}) {
    const float steepest = float(4 / billowSlope(octaves));
    EXPECT_NE(refusal(noisy(1.001F * steepest, 4, octaves)).find("a smaller --noise or a larger --noise-size"), std::string::npos);
    EXPECT_EQ(refusal(noisy(0.999F * steepest, 4, octaves)), "");
  }
  for (const float bad : {-0.1F, NAN, INFINITY}) {
    EXPECT_NE(refusal(noisy(bad, 1)), "") << bad;
    EXPECT_NE(refusal(noisy(0.01F, bad)), "") << bad;
    EXPECT_NE(refusal(noisy(0, bad)), "") << bad;
  }
  EXPECT_NE(refusal(noisy(0.01F, 0)), "");
  EXPECT_NE(refusal(noisy(0.01F, 1, 0)).find("octaves"), std::string::npos);
  EXPECT_NE(refusal(noisy(0.01F, 1, 9)).find("octaves"), std::string::npos);
  EXPECT_NE(refusal(noisy(1e-8F, 1e-6F)).find("larger --noise-size"), std::string::npos);

  // The bumps count in the estimate of the memory.
  LevelSetSettings limited = noisy(2, 20, 1);
  limited.memory_limit = 30 << 20;
  EXPECT_NE(refusal(limited).find("limit"), std::string::npos);
  limited.noise->amplitude = 0.1F;
  EXPECT_EQ(refusal(limited), "");
}

// The finest of three octaves are a quarter of the size: 2 voxels of 0.027 at 0.22.
TEST(LevelSet, FineNoiseIsReported) {
  for (const bool is_fine : {false, true}) {
    Warnings warnings;
    const double voxel_size = ofSpheres(kCluster).frame.voxel_size;
    levelSetFromSpheres(kCluster, noisy(0.01F, float((is_fine ? 7.9 : 8.1) * voxel_size)), warnings);
    EXPECT_EQ(warnings.entries().contains(WarningKind::kNoiseTooFine), is_fine);
    if (is_fine) {
      EXPECT_NE(warnings.entries().at(WarningKind::kNoiseTooFine).first.find("--noise-octaves"), std::string::npos);
    }
  }
}

TEST(LevelSet, RefusesWhatCannotBe) {
  Warnings warnings;
  LevelSetSettings absurd;
  absurd.voxels = 1000000000;
  EXPECT_THROW(ofSpheres({{{0, 0, 0}, 1}}, absurd), InputError);
  EXPECT_THROW(levelSetFromMesh(ballMesh(1, 2), absurd, warnings), InputError);
  EXPECT_THROW(ofSpheres({}), InputError);
  EXPECT_THROW(ofSpheres({{{NAN, 0, 0}, 1}}), InputError);
  EXPECT_THROW(ofSpheres({{{0, 0, 0}, 0}}), InputError);
  EXPECT_THROW(levelSetFromMesh({}, {}, warnings), InputError);
  SurfaceMesh broken = ballMesh(1, 1);
  broken.positions[7].y = NAN;
  try {
    levelSetFromMesh(broken, {}, warnings);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("vertex 7"), std::string::npos);
  }
}

// A hollow ball: a reversed inner shell is a cavity, an unreversed one counts once. OpenVDB alone fills both.
TEST(LevelSet, CavityFollowsTheWindingNumber) {
  Warnings warnings;
  const SurfaceMesh outer = ballMesh(1, 5);
  SurfaceMesh inner = ballMesh(0.5F, 5);
  const LevelSet solid = levelSetFromMesh(merged(outer, inner), {}, warnings);
  EXPECT_NEAR(insideVolume(solid), kUnitBallVolume, 0.02);
  EXPECT_LT(phiAt(solid, {0, 0, 0}), 0);
  reverse(inner);
  const LevelSet hollow = levelSetFromMesh(merged(outer, inner), {}, warnings);
  EXPECT_NEAR(insideVolume(hollow), kUnitBallVolume * 7 / 8, 0.02);
  EXPECT_GT(phiAt(hollow, {0, 0, 0}), 0);
}

TEST(LevelSet, InvertedMeshIsTheSameSolid) {
  Warnings warnings;
  SurfaceMesh ball = ballMesh(1, 5);
  reverse(ball);
  EXPECT_NEAR(insideVolume(levelSetFromMesh(ball, {}, warnings)), kUnitBallVolume, 0.02);
  EXPECT_TRUE(warnings.entries().contains(WarningKind::kInvertedMesh));
}

// A sheet of a fifth of a voxel between two layers of the grid (the small box shifts the centre): lost, and said so.
TEST(LevelSet, ThinSheetIsReported) {
  Warnings warnings;
  levelSetFromMesh(merged(boxMesh({-1, -0.002F, -1}, {1, 0.002F, 1}), boxMesh({0, 1.002F, 0}, {0.02F, 1.022F, 0.02F})), {}, warnings);
  EXPECT_TRUE(warnings.entries().contains(WarningKind::kVolumeMismatch));
}

// A hole narrower than the band closes by itself; half a ball does not, and is refused by its volume.
TEST(LevelSet, OpenMeshIsJudgedByItsVolume) {
  Warnings warnings;
  SurfaceMesh pinhole = ballMesh(1, 5);
  pinhole.triangles.pop_back();
  EXPECT_NEAR(insideVolume(levelSetFromOpenMesh(pinhole, {}, warnings)), kUnitBallVolume, 0.03);
  SurfaceMesh half_ball = ballMesh(1, 5);
  std::erase_if(half_ball.triangles, [&](const Triangle& t) { return half_ball.positions[t[0]].y < 0; });
  EXPECT_THROW(levelSetFromOpenMesh(half_ball, {}, warnings), InputError);
}

// A slab with a narrow gap and a wide one, and a sheet beside it: the narrow gap is closed, the sheet is gone, the rest stays.
TEST(LevelSet, DetailIsWhatIsNarrowerThanTwoRadii) {
  Warnings warnings;
  const auto block = [](float from, float to) { return boxMesh({from, 0, 0}, {to, 2, 2}); };
  const SurfaceMesh body = merged(merged(block(0, 1), block(1.06F, 2)), merged(block(2.4F, 3.4F), block(3.8F, 3.86F)));
  LevelSetSettings fine, coarse;
  fine.voxel_size = 0.02F, coarse.voxel_size = 0.04F;
  const LevelSet all = levelSetFromMesh(body, fine, warnings), plain = withoutDetail(all, 0.06 / 0.02);
  const auto isInside = [&](const LevelSet& level_set, Vec3 p) {
    const Vec3 index = level_set.frame.toIndex(p);
    const openvdb::Coord voxel(int(std::lround(index.x)), int(std::lround(index.y)), int(std::lround(index.z)));
    return level_set.grid->vdb->tree().getValue(voxel) < 0;
  };
  for (const auto& [x, before, after] :
       {std::tuple(0.5F, true, true), {1.03F, false, true}, {2.2F, false, false}, {3, true, true}, {3.83F, true, false}}) {
    EXPECT_EQ(isInside(all, {x, 1, 1}), before) << x;
    EXPECT_EQ(isInside(plain, {x, 1, 1}), after) << x;
  }
  const LevelSet ball = levelSetFromMesh(ballMesh(1, 5), coarse, warnings);
  EXPECT_NEAR(insideVolume(withoutDetail(ball, 3)), insideVolume(ball), 0.012 * insideVolume(ball)) << "a tenth of a voxel";
}
