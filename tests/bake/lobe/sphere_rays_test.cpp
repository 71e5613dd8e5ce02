#include "bake/lobe/sphere_rays.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <numeric>

#include "bake/field/dense_field.h"
#include "bake/field/level_set.h"
#include "bake/lobe/directions.h"
#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/surface.h"
#include "bake/truth/error_metrics.h"
#include "bake/truth/reference.h"
#include "tests/bake/lobe_helpers.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

struct Baked {
  SurfaceMesh mesh;
  std::vector<Lobe> lobes;
  Warnings warnings;
};

Baked bakeSpheres(std::vector<Sphere> spheres, BakeSettings settings, size_t vertices = 2000, int voxels = 100) {
  Baked baked;
  LevelSetSettings level_set_settings;
  level_set_settings.voxels = voxels;
  const LevelSet level_set = levelSetFromSpheres(spheres, level_set_settings, baked.warnings);
  baked.mesh = meshFromLevelSet(level_set, {.vertices = vertices}, baked.warnings);
  if (!settings.ray_length) settings.ray_length = boundingBox(baked.mesh).diagonal();
  baked.lobes = bakeSphereRays({baked.mesh.positions, baked.mesh.normals}, denseFromLevelSet(level_set), settings, baked.warnings);
  return baked;
}

const std::vector<Sphere> kCluster{{{0, 0, 0}, 1}, {{0.9F, 0.3F, 0}, 0.7F}, {{-0.7F, 0.4F, 0.5F}, 0.6F}};

class RayBallAnywhere : public testing::TestWithParam<std::pair<Vec3, float>> {};

}  // namespace

// Exact chords with 100 stratified rays give a median of 2.05° and a 95th percentile of 4.35°: little may be added by the march.
TEST_P(RayBallAnywhere, HundredStratifiedRays) {
  const auto [center, radius] = GetParam();
  const Baked baked = bakeSpheres({{center, radius}}, {});
  const BallFigures figures = ballFigures(baked.lobes, baked.mesh.positions, center, radius);
  std::printf("[figures] ball R=%g at (%g, %g, %g): median %.3f deg, p95 %.3f deg, density bias %.3f %%, worst %.3f %%\n", radius, center.x,
              center.y, center.z, figures.median, figures.p95, 100 * figures.density_bias, 100 * figures.density_worst);
  EXPECT_LT(figures.median, 2.5);
  EXPECT_LT(figures.p95, 5.5);
  EXPECT_LT(std::fabs(figures.density_bias), 0.02);
  EXPECT_LT(figures.density_worst, 0.02);
  EXPECT_TRUE(baked.warnings.empty());
}
INSTANTIATE_TEST_SUITE_P(, RayBallAnywhere,
                         testing::Values(std::pair{Vec3{0, 0, 0}, 1.0F}, std::pair{Vec3{0, 0, 0}, 1e-6F}, std::pair{Vec3{0, 0, 0}, 1e6F},
                                         std::pair{Vec3{1000, 0, 0}, 1.0F}, std::pair{Vec3{-577, 577, 577}, 1.0F}));

TEST(SphereRays, FourThousandFibonacciRays) {
  BakeSettings settings;
  settings.sampler = Sampler::kFibonacci;
  settings.rays = 4096;
  const Baked baked = bakeSpheres({{{0, 0, 0}, 1}}, settings, 200);
  const BallFigures figures = ballFigures(baked.lobes, baked.mesh.positions, {0, 0, 0}, 1);
  std::printf("[figures] ball, 4096 Fibonacci: median %.4f deg, p95 %.4f deg, density bias %.3f %%, worst %.3f %%\n", figures.median,
              figures.p95, 100 * figures.density_bias, 100 * figures.density_worst);
  EXPECT_LT(figures.median, 0.2);
  EXPECT_LT(std::fabs(figures.density_bias), 0.005);
  EXPECT_LT(figures.density_worst, 0.005);
}

// A million radii away float32 is 6 % of R coarse: finite, and said.
TEST(SphereRays, VeryFarAwayIsFiniteAndWarned) {
  const Baked baked = bakeSpheres({{{1e6F, 0, 0}, 1}}, {}, 500);
  for (const Lobe& lobe : baked.lobes) {
    ASSERT_TRUE(isFinite(lobe.direction));
    ASSERT_NEAR(length(lobe.direction), 1, 1e-5);
    ASSERT_TRUE(lobe.thickness >= 0 && lobe.thickness < 3);
  }
  EXPECT_TRUE(baked.warnings.entries().contains(WarningKind::kCoarseCoordinates));
}

// On a grid the error in ℓ falls with the step until the field's own resolution is the limit.
TEST(SphereRays, GridErrorFallsToItsFloor) {
  const std::vector<Sphere> ball{{{0, 0, 0}, 1}};
  Warnings warnings;
  const LevelSet level_set = levelSetFromSpheres(ball, {}, warnings);
  const SurfaceMesh mesh = meshFromLevelSet(level_set, {.vertices = 150}, warnings);
  const auto directions = fibonacciDirections(256);
  const auto truth = trueLengths(*sphereReference(ball), mesh.positions, directions, 4);
  std::vector<double> errors;
  for (const int steps : {60, 120, 240, 480, 960}) {
    BakeSettings settings;
    settings.steps = steps;
    settings.ray_length = 4.0F;
    const auto lengths = marchedLengths(mesh.positions, directions, denseFromLevelSet(level_set), settings);
    double squares = 0;
    for (size_t i = 0; i < lengths.size(); ++i) squares += std::pow(lengths[i] - truth[i], 2);
    errors.push_back(std::sqrt(squares / double(lengths.size())));
    std::printf("[figures] ball at 100 voxels, crossing, step %.2f voxels: rms %.5f R\n", 4.0 / steps / level_set.frame.voxel_size,
                errors.back());
  }
  EXPECT_LT(errors[1], 0.5 * errors[0]);
  EXPECT_LT(errors[4], 0.02);
  EXPECT_LE(errors[4], errors[1]);
}

// Two balls apart: lobes against the union of intervals, through the gap. Formula: bake/truth/reference.cpp.
TEST(SphereRays, TwoBallsAgreeWithIntervals) {
  const std::vector<Sphere> two{{{0, 0, 0}, 1}, {{2.4F, 0.3F, 0}, 0.7F}};
  BakeSettings settings;
  settings.sampler = Sampler::kFibonacci;
  settings.rays = 1000;
  settings.steps = 300;
  const Baked baked = bakeSpheres(two, settings, 400, 150);
  const Truth truth = trueLobes(*sphereReference(two), baked.mesh.positions, fibonacciDirections(4096), INFINITY);
  const LobeError error = compareLobes(baked.lobes, truth);
  std::printf("[figures] two balls, 1000 Fibonacci: rms %.3f deg, median %.3f deg, density rms %.3f %%, bias %.3f %%\n",
              error.angle_rms_degrees, error.angle_median_degrees, 100 * error.density_rms, 100 * error.density_bias);
  EXPECT_LT(error.angle_median_degrees, 0.5);
  EXPECT_LT(error.angle_p95_degrees, 1.5);
  EXPECT_LT(std::fabs(error.density_bias), 0.01);
}

// A torus from its mesh. Independent truth: exact chords by Embree, themselves held to the closed form in reference_test.
TEST(SphereRays, TorusAgreesWithExactChords) {
  SurfaceMesh torus = torusMesh(1, 0.4F, 128, 64);
  Warnings warnings;
  LevelSetSettings level_set_settings;
  level_set_settings.voxels = 150;
  const LevelSet level_set = levelSetFromMesh(torus, level_set_settings, warnings);
  BakeSettings settings;
  settings.sampler = Sampler::kFibonacci;
  settings.rays = 1000;
  settings.steps = 200;
  settings.ray_length = boundingBox(torus).diagonal();
  std::vector<Vec3> positions, normals;
  for (size_t v = 0; v < torus.positions.size(); v += 37) positions.push_back(torus.positions[v]), normals.push_back(torus.normals[v]);
  const auto lobes = bakeSphereRays({positions, normals}, denseFromLevelSet(level_set), settings, warnings);
  const LobeError error = compareLobes(lobes, trueLobes(*meshReference(torus), positions, fibonacciDirections(4096), INFINITY));
  std::printf("[figures] torus, 1000 Fibonacci: rms %.3f deg, median %.3f deg, density rms %.3f %%, bias %.3f %%\n",
              error.angle_rms_degrees, error.angle_median_degrees, 100 * error.density_rms, 100 * error.density_bias);
  EXPECT_LT(error.angle_median_degrees, 0.5);
  EXPECT_LT(std::fabs(error.density_bias), 0.02);
}

TEST(SphereRays, SameBytesForAnyThreadCountAndRun) {
  const Baked first = bakeSpheres(kCluster, {}, 500);
  for (const size_t threads : {1, 2, 7}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    const Baked again = bakeSpheres(kCluster, {}, 500);
    EXPECT_TRUE(sameBytes(first.lobes, again.lobes)) << threads;
  }
}

// A point's lobe depends on the point, not on its place in the list.
TEST(SphereRays, OrderOfVerticesDoesNotMatter) {
  Warnings warnings;
  const LevelSet level_set = levelSetFromSpheres(kCluster, {}, warnings);
  const SurfaceMesh mesh = meshFromLevelSet(level_set, {.vertices = 500}, warnings);
  BakeSettings settings;
  settings.ray_length = 4.0F;
  const auto forwards = bakeSphereRays({mesh.positions, mesh.normals}, denseFromLevelSet(level_set), settings, warnings);
  std::vector<Vec3> positions(mesh.positions.rbegin(), mesh.positions.rend()), normals(mesh.normals.rbegin(), mesh.normals.rend());
  auto backwards = bakeSphereRays({positions, normals}, denseFromLevelSet(level_set), settings, warnings);
  std::reverse(backwards.begin(), backwards.end());
  EXPECT_TRUE(sameBytes(forwards, backwards));
}

// Scale by 2^10: directions bit for bit, densities × 2^10.
TEST(SphereRays, PowersOfTwoScaleExactly) {
  std::vector<Sphere> large = kCluster;
  for (Sphere& s : large) s.center = s.center * 1024, s.radius *= 1024;
  const Baked a = bakeSpheres(kCluster, {}, 400), b = bakeSpheres(large, {}, 400);
  ASSERT_EQ(a.lobes.size(), b.lobes.size());
  for (size_t v = 0; v < a.lobes.size(); ++v) {
    ASSERT_EQ(a.lobes[v].direction, b.lobes[v].direction);
    ASSERT_EQ(a.lobes[v].thickness * 1024, b.lobes[v].thickness);
  }
}

// A rotated cluster gives rotated lobes, to the noise of the rays and the grid.
TEST(SphereRays, RotationTurnsTheLobes) {
  const auto turned = [](Vec3 p) { return Vec3{0.8F * p.x - 0.6F * p.y, 0.6F * p.x + 0.8F * p.y, p.z}; };
  std::vector<Sphere> rotated = kCluster;
  for (Sphere& s : rotated) s.center = turned(s.center);
  Warnings warnings;
  BakeSettings settings;
  settings.sampler = Sampler::kFibonacci;
  settings.rays = 1000;
  settings.ray_length = 4.0F;
  const LevelSet level_set = levelSetFromSpheres(kCluster, {}, warnings), level_set_turned = levelSetFromSpheres(rotated, {}, warnings);
  const SurfaceMesh mesh = meshFromLevelSet(level_set, {.vertices = 250}, warnings);
  std::vector<Vec3> positions;
  for (const Vec3& p : mesh.positions) positions.push_back(turned(p));
  const auto straight = bakeSphereRays({mesh.positions, {}}, denseFromLevelSet(level_set), settings, warnings);
  const auto other = bakeSphereRays({positions, {}}, denseFromLevelSet(level_set_turned), settings, warnings);
  std::vector<double> angles;
  for (size_t v = 0; v < straight.size(); ++v) angles.push_back(angleDegrees(turned(straight[v].direction), other[v].direction));
  std::sort(angles.begin(), angles.end());
  EXPECT_LT(angles[angles.size() / 2], 0.5);
  EXPECT_LT(angles[angles.size() * 95 / 100], 2.0);
}

// The centre of a ball sees as much on every side, a far point sees nothing: −normal (or −Y), counted, finite.
TEST(SphereRays, UndefinedDirectionsAreCounted) {
  Warnings warnings;
  const std::vector<Sphere> ball{{{0, 0, 0}, 1}};
  const LevelSet level_set = levelSetFromSpheres(ball, {}, warnings);
  BakeSettings settings;
  settings.ray_length = 3.0F;
  const std::vector<Vec3> positions{{0, 0, 0}, {50, 0, 0}, {0, 1, 0}}, normals{{1, 0, 0}, {0, 0, 1}, {0, 1, 0}};
  const auto lobes = bakeSphereRays({positions, normals}, denseFromLevelSet(level_set), settings, warnings);
  EXPECT_EQ(warnings.entries().at(WarningKind::kUndefinedDirection).count, 2U);
  EXPECT_EQ(lobes[0].direction, (Vec3{-1, 0, 0}));
  EXPECT_NEAR(lobes[0].thickness, 1, 0.01);
  EXPECT_EQ(lobes[1].direction, (Vec3{0, 0, -1}));
  EXPECT_EQ(lobes[1].thickness, 0);
  EXPECT_EQ(bakeSphereRays({positions, {}}, denseFromLevelSet(level_set), settings, warnings)[1].direction, (Vec3{0, -1, 0}));
}

// m of two opposite equal chords is zero; of one chord it is that chord with κ = 1.
TEST(SphereRays, MeanDirectionByHand) {
  const Vec3 directions[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}};
  EXPECT_EQ(meanDirection(directions, std::vector<float>{1, 1, 0}).concentration, 0);
  EXPECT_EQ(meanDirection(directions, std::vector<float>{0, 0, 2}).direction, (Vec3{0, 1, 0}));
  EXPECT_EQ(meanDirection(directions, std::vector<float>{0, 0, 2}).concentration, 1);
  EXPECT_EQ(meanDirection(directions, std::vector<float>{0, 0, 0}).concentration, 0);
  const MeanDirection mixed = meanDirection(directions, std::vector<float>{2, 1, 1});  // (4 − 1, 1, 0) / 6
  EXPECT_NEAR(mixed.direction.x, 3 / std::sqrt(10.0), 1e-6);
  EXPECT_NEAR(mixed.concentration, std::sqrt(10.0) / 6, 1e-9);
}

// Quadratures and samplers all reach the ball, each within what its bias allows.
TEST(SphereRays, EveryEstimatorFindsTheBall) {
  for (const Quadrature quadrature : {Quadrature::kCrossing, Quadrature::kMidpoint, Quadrature::kEnd})
    for (const Sampler sampler : {Sampler::kStratified, Sampler::kFibonacci, Sampler::kUniform}) {
      BakeSettings settings;
      settings.quadrature = quadrature;
      settings.sampler = sampler;
      const Baked baked = bakeSpheres({{{0, 0, 0}, 1}}, settings, 200, 50);
      const BallFigures figures = ballFigures(baked.lobes, baked.mesh.positions, {0, 0, 0}, 1);
      EXPECT_LT(figures.median, sampler == Sampler::kUniform ? 9 : 3) << int(quadrature) << int(sampler);
      EXPECT_LT(figures.density_worst, sampler == Sampler::kUniform ? 0.12 : 0.04);
    }
}
