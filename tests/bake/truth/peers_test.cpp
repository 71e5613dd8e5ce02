#include "bake/truth/peers.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>

#include "bake/field/level_set.h"
#include "bake/lobe/directions.h"
#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/surface.h"
#include "bake/truth/error_metrics.h"
#include "tests/bake/lobe_helpers.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

LevelSet ballLevelSet(int voxels = 100) {
  Warnings warnings;
  LevelSetSettings settings;
  settings.voxels = voxels;
  return levelSetFromSpheres(std::vector<Sphere>{{{0, 0, 0}, 1}}, settings, warnings);
}

// Every 37th vertex of a torus, its level set and its exact chords.
struct Torus {
  std::vector<Vec3> positions, normals;
  LevelSet level_set;
  std::unique_ptr<Reference> reference;
  BakeSettings settings;
  Truth truth;
  BakePoints points() const { return {positions, normals}; }
};

Torus torusCase() {
  Torus torus;
  const SurfaceMesh mesh = torusMesh(1, 0.4F, 128, 64);
  for (size_t v = 0; v < mesh.positions.size(); v += 37)
    torus.positions.push_back(mesh.positions[v]), torus.normals.push_back(mesh.normals[v]);
  Warnings warnings;
  LevelSetSettings level_set_settings;
  level_set_settings.voxels = 150;
  torus.level_set = levelSetFromMesh(mesh, level_set_settings, warnings);
  torus.reference = meshReference(mesh);
  torus.settings.sampler = Sampler::kFibonacci;
  torus.settings.rays = 1000;
  torus.settings.steps = 200;
  torus.settings.ray_length = boundingBox(mesh).diagonal();
  torus.truth = trueLobes(*torus.reference, torus.positions, fibonacciDirections(4096), INFINITY);
  return torus;
}

LobeError torusError(const char* peer, const std::vector<Lobe>& lobes, const Truth& truth) {
  const LobeError error = compareLobes(lobes, truth);
  std::printf("[figures] torus, 1000 Fibonacci, %s: rms %.3f deg, median %.3f deg, density rms %.3f %%, bias %.3f %%\n", peer,
              error.angle_rms_degrees, error.angle_median_degrees, 100 * error.density_rms, 100 * error.density_bias);
  return error;
}

struct LengthFigures {
  double rms, worst;
};

LengthFigures compareChords(std::span<const float> estimate, std::span<const float> truth) {
  double squares = 0, worst = 0;
  for (size_t i = 0; i < truth.size(); ++i) {
    const double error = double(estimate[i]) - truth[i];
    squares += error * error, worst = std::max(worst, std::fabs(error));
  }
  return {std::sqrt(squares / double(truth.size())), worst};
}

}  // namespace

// Chords from a ball's surface are 2R cos θ. A grazing chord is where a grid errs most: an error e of the surface moves its end by e / cos
// θ.
TEST(Peers, HddaChordsOfABall) {
  const LevelSet level_set = ballLevelSet();
  const auto positions = ballMesh(1, 3).positions, directions = fibonacciDirections(256);
  const auto lengths = hddaLengths(positions, directions, level_set, INFINITY);
  std::vector<float> truth;
  for (const Vec3& p : positions)
    for (const Vec3& w : directions) truth.push_back(2 * std::max(0.0F, -dot(p, w)));
  const LengthFigures figures = compareChords(lengths, truth);
  const double voxel = level_set.frame.voxel_size;
  std::printf("[figures] ball, hierarchical: rms %.3f voxels, worst %.2f voxels\n", figures.rms / voxel, figures.worst / voxel);
  EXPECT_LT(figures.rms, 0.1 * voxel);
  EXPECT_LT(figures.worst, 3 * voxel);
}

// From the centre R, from the surface 2R, from outside 2R through and 0 past it; cut at L in each case.
TEST(Peers, HddaChordsByHand) {
  const LevelSet level_set = ballLevelSet();
  const double tolerance = 0.05 * level_set.frame.voxel_size;
  const auto along = [&](Vec3 from, Vec3 direction, double length) {
    return double(hddaLengths({&from, 1}, {&direction, 1}, level_set, length).front());
  };
  for (const Vec3 w : {Vec3{1, 0, 0}, Vec3{0, -1, 0}, *normalized(Vec3{1, 1, 1}), *normalized(Vec3{-3, 1, 0.1F})}) {
    EXPECT_NEAR(along({0, 0, 0}, w, INFINITY), 1, tolerance);
    EXPECT_NEAR(along({0, 0, 0}, w, 0.25), 0.25, tolerance);
    EXPECT_NEAR(along(-w, w, INFINITY), 2, tolerance);
    EXPECT_NEAR(along(-w, w, 1.5), 1.5, tolerance);
    EXPECT_NEAR(along(-w, -w, INFINITY), 0, tolerance);
    EXPECT_NEAR(along(-3 * w, w, INFINITY), 2, tolerance);
    EXPECT_NEAR(along(-3 * w, w, 3), 1, tolerance);
    EXPECT_EQ(along(-3 * w, w, 1), 0);
    EXPECT_EQ(along(3 * w, w, INFINITY), 0);
  }
}

// Gaps do not count: two balls of radius 1 and 0.7 on a line, 0.7 apart; a cavity neither.
TEST(Peers, HddaLeavesGapsOut) {
  Warnings warnings;
  const Vec3 origin{-3, 0, 0}, right{1, 0, 0};
  const LevelSet apart = levelSetFromSpheres(std::vector<Sphere>{{{0, 0, 0}, 1}, {{2.4F, 0, 0}, 0.7F}}, {}, warnings);
  EXPECT_NEAR(hddaLengths({&origin, 1}, {&right, 1}, apart, INFINITY).front(), 3.4, 0.1 * apart.frame.voxel_size);
  EXPECT_NEAR(hddaLengths({&origin, 1}, {&right, 1}, apart, 5.2).front(), 2.5, 0.1 * apart.frame.voxel_size);
  SurfaceMesh inner = boxMesh({-1, -1, -1}, {1, 1, 1});
  reverse(inner);
  const LevelSet hollow = levelSetFromMesh(merged(boxMesh({-2, -2, -2}, {2, 2, 2}), inner), {}, warnings);
  EXPECT_NEAR(hddaLengths({&origin, 1}, {&right, 1}, hollow, INFINITY).front(), 2, 0.1 * hollow.frame.voxel_size);
}

// Exact chords with 100 stratified rays give a median of 2.05° and a 95th percentile of 4.35°: little may be added by any peer.
TEST(Peers, BallByAll) {
  const LevelSet level_set = ballLevelSet();
  const SurfaceMesh mesh = ballMesh(1, 4);
  const BakePoints points{mesh.positions, mesh.normals};
  const auto reference = sphereReference(std::vector<Sphere>{{{0, 0, 0}, 1}});
  BakeSettings settings;
  settings.ray_length = 4.0F;
  Warnings warnings;
  for (const auto& lobes : {plainSphereRays(points, level_set, settings, warnings), hddaSphereRays(points, level_set, settings, warnings),
                            referenceSphereRays(points, *reference, settings, warnings)}) {
    ASSERT_EQ(lobes.size(), mesh.positions.size());
    std::vector<double> angles;
    double density_worst = 0;
    for (size_t v = 0; v < lobes.size(); ++v) {
      const Lobe truth = ballLobe(mesh.positions[v], {}, 1);
      angles.push_back(angleDegrees(lobes[v].direction, truth.direction));
      density_worst = std::max(density_worst, std::fabs(double(lobes[v].thickness) / truth.thickness - 1));
    }
    std::sort(angles.begin(), angles.end());
    const double median = angles[angles.size() / 2], p95 = angles[angles.size() * 95 / 100];
    std::printf("[figures] ball: median %.3f deg, p95 %.3f deg, density worst %.3f %%\n", median, p95, 100 * density_worst);
    EXPECT_LT(median, 2.5);
    EXPECT_LT(p95, 5.5);
    EXPECT_LT(density_worst, 0.02);
  }
  EXPECT_TRUE(warnings.empty());
}

// Embree finds the chords of an inscribed fine icosphere, whose facets' sagitta is under 1.2e-4.
TEST(Peers, EmbreeBallIsNearlyExact) {
  const SurfaceMesh mesh = ballMesh(1, 6);
  BakeSettings settings;
  settings.ray_length = 4.0F;
  settings.rays = 1000;
  settings.sampler = Sampler::kFibonacci;
  std::vector<Vec3> positions, normals;
  for (size_t v = 0; v < mesh.positions.size(); v += 199) positions.push_back(mesh.positions[v]), normals.push_back(mesh.normals[v]);
  Warnings warnings;
  const auto lobes = referenceSphereRays({positions, normals}, *meshReference(mesh), settings, warnings);
  for (size_t v = 0; v < lobes.size(); ++v) {
    EXPECT_LT(angleDegrees(lobes[v].direction, -normals[v]), 0.5);
    EXPECT_NEAR(lobes[v].thickness, 2, 1e-3);
  }
}

TEST(Peers, TorusByAll) {
  const Torus torus = torusCase();
  Warnings warnings;
  const LobeError plain = torusError("plain", plainSphereRays(torus.points(), torus.level_set, torus.settings, warnings), torus.truth),
                  hdda = torusError("hdda", hddaSphereRays(torus.points(), torus.level_set, torus.settings, warnings), torus.truth),
                  embree =
                      torusError("embree", referenceSphereRays(torus.points(), *torus.reference, torus.settings, warnings), torus.truth);
  for (const LobeError& error : {plain, hdda, embree}) {
    EXPECT_GT(error.vertices, 200U);
    EXPECT_LT(error.angle_median_degrees, 0.5);
    EXPECT_LT(std::fabs(error.density_bias), 0.02);
  }
  // The same set of directions, so the same noise: what is left is the field, which exact chords do without.
  EXPECT_LT(std::fabs(embree.density_bias), std::fabs(plain.density_bias));
  EXPECT_LT(hdda.angle_rms_degrees, 1.1 * plain.angle_rms_degrees);
  EXPECT_LT(hdda.density_rms, 1.1 * plain.density_rms);
}

TEST(Peers, SameBytesForAnyThreadCount) {
  const Torus torus = torusCase();
  BakeSettings settings = torus.settings;
  settings.rays = 50, settings.steps = 50;
  const auto run = [&] {
    Warnings warnings;
    return std::array{plainSphereRays(torus.points(), torus.level_set, settings, warnings),
                      hddaSphereRays(torus.points(), torus.level_set, settings, warnings),
                      referenceSphereRays(torus.points(), *torus.reference, settings, warnings)};
  };
  const auto first = run();
  for (const size_t threads : {1, 2, 7}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    const auto again = run();
    for (size_t peer = 0; peer < first.size(); ++peer) EXPECT_TRUE(sameBytes(first[peer], again[peer])) << threads << " " << peer;
  }
}

// Nothing around: −normal, or −Y without normals, counted.
TEST(Peers, UndefinedDirectionsAreCounted) {
  const LevelSet level_set = ballLevelSet(30);
  BakeSettings settings;
  settings.ray_length = 3.0F;
  const std::vector<Vec3> positions{{50, 0, 0}, {0, 1, 0}}, normals{{0, 0, 1}, {0, 1, 0}};
  const auto reference = sphereReference(std::vector<Sphere>{{{0, 0, 0}, 1}});
  Warnings warnings;
  EXPECT_EQ(plainSphereRays({positions, normals}, level_set, settings, warnings)[0].direction, (Vec3{0, 0, -1}));
  EXPECT_EQ(hddaSphereRays({positions, normals}, level_set, settings, warnings)[0].direction, (Vec3{0, 0, -1}));
  EXPECT_EQ(referenceSphereRays({positions, {}}, *reference, settings, warnings)[0].direction, (Vec3{0, -1, 0}));
  EXPECT_EQ(warnings.entries().at(WarningKind::kUndefinedDirection).count, 3U);
}
