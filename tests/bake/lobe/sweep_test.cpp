#include "bake/lobe/sweep.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <numeric>

#include "bake/field/coverage.h"
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

BakeSettings sweepSettings(int directions, float ray_length) {
  BakeSettings settings;
  settings.method = Method::kSweep;
  settings.rays = directions;
  settings.ray_length = ray_length;
  return settings;
}

// Every n-th vertex.
struct Points {
  std::vector<Vec3> positions, normals;
  BakePoints view() const { return {positions, normals}; }
};
Points everyNth(const SurfaceMesh& mesh, size_t step) {
  Points points;
  for (size_t v = 0; v < mesh.positions.size(); v += step) {
    points.positions.push_back(mesh.positions[v]);
    if (!mesh.normals.empty()) points.normals.push_back(mesh.normals[v]);
  }
  return points;
}

// Root mean square of swept − true lengths, in cells; `truth(p, ω)`, not a number for what is to be left out.
template <class TrueLength>
double rmsCells(std::span<const Vec3> positions, std::span<const Vec3> axes, const CoverageField& field, double ray_length,
                const TrueLength& truth) {
  const std::vector<float> lengths = sweptLengths(positions, axes, field, ray_length);
  const std::vector<Vec3> senses = bothSenses(axes);
  double squares = 0;
  size_t count = 0;
  for (size_t n = 0; n < senses.size(); ++n)
    for (size_t v = 0; v < positions.size(); ++v) {
      const double error = lengths[n * positions.size() + v] - truth(positions[v], senses[n]);
      if (std::isnan(error)) continue;
      squares += error * error, ++count;
    }
  return std::sqrt(squares / double(count)) / field.frame.voxel_size;
}

void expectFinite(std::span<const Lobe> lobes, float longest) {
  for (const Lobe& lobe : lobes) {
    ASSERT_TRUE(isFinite(lobe.direction));
    ASSERT_NEAR(length(lobe.direction), 1, 1e-5);
    ASSERT_TRUE(lobe.thickness >= -longest && lobe.thickness <= longest) << lobe.thickness;
  }
}

// The x, y and z axes, the diagonals of the faces and of the cube in all senses: ties of the largest component.
std::vector<Vec3> axesAndDiagonals() {
  std::vector<Vec3> axes;
  for (const float z : {-1.0F, 0.0F, 1.0F})
    for (const float y : {-1.0F, 0.0F, 1.0F})
      for (const float x : {-1.0F, 0.0F, 1.0F})
        if (x != 0 || y != 0 || z != 0) axes.push_back(*normalized(Vec3{x, y, z}));
  return axes;
}

// A union of a dozen unblended spheres as one closed mesh.
SurfaceMesh dozenSpheres(int voxels) {
  std::vector<Sphere> spheres;
  for (int n = 0; n < 12; ++n) {
    const float turn = 2.4F * float(n), height = float(n % 4) * 0.35F;
    spheres.push_back(
        {{std::cos(turn) * (0.4F + 0.1F * float(n)), height, std::sin(turn) * (0.3F + 0.07F * float(n))}, 0.7F - 0.03F * float(n)});
  }
  Warnings warnings;
  LevelSetSettings settings;
  settings.voxels = voxels;
  return meshFromLevelSet(levelSetFromSpheres(spheres, settings, warnings), {}, warnings);
}

uint64_t hashOf(const void* data, size_t bytes, uint64_t hash = 0xCBF29CE484222325ULL) {
  for (size_t i = 0; i < bytes; ++i) hash = (hash ^ static_cast<const unsigned char*>(data)[i]) * 0x100000001B3ULL;  // FNV-1a
  return hash;
}

class BallAnywhere : public testing::TestWithParam<std::pair<Vec3, float>> {};

}  // namespace

// From a point on a ball, ℓ = 2R max(0, cos θ). Where the line does not graze the surface the error stays bounded in cells. Grazing lines
// run within a cell of the surface for √(Rh), in a share √(h/R) of the directions: over all the rms falls as h^0.75.
TEST(Sweep, BallChordsConverge) {
  const SurfaceMesh ball = ballMesh(1, 6);
  const Points points = everyNth(ball, 53);
  const auto axes = sweepAxes(60);
  const auto truth = [](Vec3 p, Vec3 w) { return 2 * std::max(0.0, -double(dot(p, w))); };
  std::vector<double> world;
  for (const int voxels : {20, 40, 80, 160}) {
    const CoverageField field = coverageOf(ball, voxels);
    const double cells = rmsCells(points.positions, axes, field, 4, truth);
    const double steep =
        rmsCells(points.positions, axes, field, 4, [&](Vec3 p, Vec3 w) { return std::fabs(dot(p, w)) > 0.5F ? truth(p, w) : NAN; });
    world.push_back(cells * field.frame.voxel_size);
    std::printf("[figures] ball, chords swept at %d voxels: rms %.3f cells, %.5f R; steeper than 30 deg %.3f cells\n", voxels, cells,
                world.back(), steep);
    EXPECT_LT(cells, 1.0);
    EXPECT_LT(steep, 0.55);
  }
  const double slope = std::log(world.front() / world.back()) / std::log(8.0);
  std::printf("[figures] ball, chords swept: rms in R falls by h^%.2f\n", slope);
  EXPECT_GT(slope, 0.7);
}

// A torus has chords in two pieces: against Embree's exact chords, from every vertex along 60 directions.
TEST(Sweep, TorusChordsConverge) {
  const SurfaceMesh torus = torusMesh(1, 0.4F, 192, 96);
  const Points points = everyNth(torus, 61);
  const auto axes = sweepAxes(60);
  const auto reference = meshReference(torus);
  const auto truth = [&](Vec3 p, Vec3 w) { return reference->insideLength({p, w}, INFINITY); };
  std::vector<double> world;
  for (const int voxels : {40, 80, 160}) {
    const CoverageField field = coverageOf(torus, voxels);
    const double cells = rmsCells(points.positions, axes, field, 4, truth);
    world.push_back(cells * field.frame.voxel_size);
    std::printf("[figures] torus, chords swept at %d voxels: rms %.3f cells, %.5f R\n", voxels, cells, world.back());
    EXPECT_LT(cells, 1.0);
  }
  const double slope = std::log(world.front() / world.back()) / std::log(4.0);
  std::printf("[figures] torus, chords swept: rms in R falls by h^%.2f\n", slope);
  EXPECT_GT(slope, 0.65);
}

// Ahead and behind make up the whole chord of the line, for points anywhere inside: 2√(R² − b²). Along axes and diagonals, with ties of the
// largest component, the lattice lines up with the line: up to a cell at either end, and no more than a fifth in the mean over the points.
TEST(Sweep, AheadAndBehindAreTheWholeChord) {
  const SurfaceMesh ball = ballMesh(1, 6);
  const CoverageField field = coverageOf(ball, 60);
  std::vector<Vec3> positions{{0, 0, 0}};
  for (const Vec3& w : fibonacciDirections(200)) positions.push_back(w * (0.1F + 0.004F * float(positions.size())));
  auto axes = axesAndDiagonals();
  for (const Vec3& axis : sweepAxes(30)) axes.push_back(axis);
  const auto lengths = sweptLengths(positions, axes, field, 4);
  const size_t count = positions.size();
  double worst = 0;
  for (size_t n = 0; n < axes.size(); ++n) {
    double bias_ahead = 0, bias_behind = 0, squares = 0;
    for (size_t v = 0; v < count; ++v) {
      const double along = dot(positions[v], axes[n]), half_chord = std::sqrt(1 - double(dot(positions[v], positions[v])) + along * along);
      const double ahead = (lengths[2 * n * count + v] - (half_chord - along)) / field.frame.voxel_size;
      const double behind = (lengths[(2 * n + 1) * count + v] - (half_chord + along)) / field.frame.voxel_size;
      worst = std::max({worst, std::fabs(ahead), std::fabs(behind)});
      bias_ahead += ahead / double(count), bias_behind += behind / double(count),
          squares += (ahead + behind) * (ahead + behind) / double(count);
    }
    EXPECT_LT(std::fabs(bias_ahead), 0.2) << n;
    EXPECT_LT(std::fabs(bias_behind), 0.2) << n;
    EXPECT_LT(std::sqrt(squares), 1.2) << n;
  }
  std::printf("[figures] ball at 60 voxels, chord from inside: worst %.2f cells\n", worst);
  EXPECT_LT(worst, 2);
}

// An axis and its opposite are the same line: ahead of one is behind of the other, to the bit.
TEST(Sweep, OppositeAxesSwapTheirSenses) {
  const SurfaceMesh torus = torusMesh(1, 0.4F, 96, 48);
  const CoverageField field = coverageOf(torus, 50);
  const Points points = everyNth(torus, 97);
  const auto axes = sweepAxes(20);
  std::vector<Vec3> opposite;
  for (const Vec3& axis : axes) opposite.push_back(-axis);
  for (const double ray_length : {0.5, 4.0}) {
    const auto forwards = sweptLengths(points.positions, axes, field, ray_length),
               backwards = sweptLengths(points.positions, opposite, field, ray_length);
    const size_t count = points.positions.size();
    for (size_t n = 0; n < axes.size(); ++n)
      for (size_t v = 0; v < count; ++v) {
        ASSERT_EQ(forwards[2 * n * count + v], backwards[(2 * n + 1) * count + v]);
        ASSERT_EQ(forwards[(2 * n + 1) * count + v], backwards[2 * n * count + v]);
      }
  }
}

// Points that are kept give the lengths of a sweep, direction by direction, in any order, also where rays end early.
TEST(Sweep, KeptPointsGiveTheSameLengths) {
  const SurfaceMesh torus = torusMesh(1, 0.4F, 96, 48);
  const Points points = everyNth(torus, 97);
  auto axes = axesAndDiagonals();
  for (const Vec3& axis : sweepAxes(20)) axes.push_back(-axis);
  for (const double ray_length : {0.5, 4.0}) {
    CoverageField field = coverageOf(torus, 50);
    const auto lengths = sweptLengths(points.positions, axes, field, ray_length);
    const SweptPoints kept(points.positions, field, ray_length);
    field = {};
    const size_t count = points.positions.size();
    for (size_t n = axes.size(); n-- > 0;)
      for (const bool ahead : {true, false}) {
        const std::vector<float> one = kept.lengths(ahead ? axes[n] : -axes[n]);
        ASSERT_EQ(one.size(), count);
        for (size_t v = 0; v < count; ++v) ASSERT_EQ(one[v], lengths[(2 * n + (ahead ? 0 : 1)) * count + v]);
      }
  }
}

// A box on the borders of cells: chords along its axes are whole numbers of cells, and inside it the split at a point is exact.
TEST(Sweep, BoxChordsAlongAxesAreExact) {
  const CoverageField field = coverageFromMesh(boxMesh({-6.5F, -10.5F, -14.5F}, {6.5F, 10.5F, 14.5F}), GridFrame{}).value();
  const Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const Vec3 positions[] = {{0, 0, 0}, {1.3F, -2.6F, 3.9F}, {-4.4F, 7.2F, -11.7F}, {3.5F, 0.5F, 0.25F}};
  const auto lengths = sweptLengths(positions, axes, field, 100);
  for (size_t n = 0; n < 3; ++n)
    for (size_t v = 0; v < std::size(positions); ++v) {
      const double half_side[] = {6.5, 10.5, 14.5}, at[] = {positions[v].x, positions[v].y, positions[v].z};
      EXPECT_NEAR(lengths[2 * n * 4 + v], half_side[n] - at[n], 1e-4) << n << ' ' << v;
      EXPECT_NEAR(lengths[(2 * n + 1) * 4 + v], half_side[n] + at[n], 1e-4) << n << ' ' << v;
    }
}

// Whatever the direction, a sweep keeps the volume: the chords of all lines of a lattice across it add up to the fractions of all cells.
TEST(Sweep, ChordsAddUpToTheVolume) {
  Warnings warnings;
  LevelSetSettings settings;
  settings.voxel_size = 1.0F;
  const LevelSet level_set = levelSetFromSpheres(std::vector<Sphere>{{{0, 0, 0}, 5}, {{4, 1, 2}, 4}}, settings, warnings);
  constexpr int kReach = 30;  // so wide that every line through the cloud meets the middle slices inside the field
  const Vec3 corners[] = {{-kReach, -kReach, -kReach}, {kReach, kReach, kReach}};
  const CoverageField field = coverageFromLevelSet(level_set, corners);
  double volume = 0;
  for (const float fraction : field.fractions) volume += double(fraction);
  auto axes = axesAndDiagonals();
  for (const Vec3& axis : sweepAxes(30)) axes.push_back(axis);
  for (const Vec3& axis : axes) {
    const float x = std::fabs(axis.x), y = std::fabs(axis.y), z = std::fabs(axis.z), main = std::max({x, y, z});
    std::vector<Vec3> positions;
    for (int i = -kReach + 1; i < kReach; ++i)
      for (int j = -kReach + 1; j < kReach; ++j) {
        const float a = float(i), b = float(j);
        const Vec3 index = main == z ? Vec3{a, b, 0} : main == y ? Vec3{a, 0, b} : Vec3{0, a, b};
        positions.push_back(field.frame.toWorld(index));
      }
    double sum = 0;
    for (const float length : sweptLengths(positions, {&axis, 1}, field, 1000)) sum += double(length);
    EXPECT_NEAR(sum * double(main) / volume, 1, 1e-4) << axis.x << ' ' << axis.y << ' ' << axis.z;
  }
}

// ℓ(p, ω; L) with L under the chord: against min(L, chord) on a ball and, with gaps, against Embree's chords cut at the same L on a torus.
TEST(Sweep, ShortRaysAreCutWhereTheyEnd) {
  const SurfaceMesh ball = ballMesh(1, 6), torus = torusMesh(1, 0.4F, 192, 96);
  const auto axes = sweepAxes(60);
  const auto reference = meshReference(torus);
  for (const double share : {0.1, 0.5, 0.9}) {
    const double of_ball = share * boundingBox(ball).diagonal(), of_torus = share * boundingBox(torus).diagonal();
    const double ball_cells = rmsCells(everyNth(ball, 97).positions, axes, coverageOf(ball, 60), of_ball,
                                       [&](Vec3 p, Vec3 w) { return std::min(of_ball, 2 * std::max(0.0, -double(dot(p, w)))); });
    const double torus_cells = rmsCells(everyNth(torus, 97).positions, axes, coverageOf(torus, 80), of_torus, [&](Vec3 p, Vec3 w) {
      return reference->insideLength({p, w}, of_torus);
    });
    std::printf("[figures] L = %.1f diagonals: rms %.3f cells on the ball, %.3f on the torus\n", share, ball_cells, torus_cells);
    EXPECT_LT(ball_cells, 0.8) << share;
    EXPECT_LT(torus_cells, 0.9) << share;
  }
}

// From the diagonal on the length of a ray changes nothing, not a bit.
TEST(Sweep, RaysOfTheDiagonalAreUncut) {
  for (const SurfaceMesh& mesh : {torusMesh(1, 0.4F, 96, 48), boxMesh({-1, -0.5F, -0.25F}, {1, 0.5F, 0.25F}), ballMesh(1, 4)})
    for (const int voxels : {1, 3, 10, 50}) {
      const CoverageField field = coverageOf(mesh, voxels);
      const Points points = everyNth(mesh, mesh.positions.size() / 8);
      const auto axes = sweepAxes(30);
      const float diagonal = boundingBox(mesh).diagonal();
      const auto uncut = sweptLengths(points.positions, axes, field, 1000);
      EXPECT_EQ(uncut, sweptLengths(points.positions, axes, field, diagonal)) << voxels;
      Warnings warnings;
      const auto lobes = bakeSweep(points.view(), field, sweepSettings(30, 1000), warnings);
      const auto at_diagonal = bakeSweep(points.view(), field, sweepSettings(30, diagonal), warnings);
      for (size_t v = 0; v < lobes.size(); ++v) EXPECT_EQ(lobes[v].direction, at_diagonal[v].direction) << voxels;
    }
}

// The lobe's density and direction follow L as well: from a pole of the ball with L = R, o stays the inward normal and d = R.
TEST(Sweep, LobesFollowTheRayLength) {
  const SurfaceMesh ball = ballMesh(1, 6);
  const Points points = everyNth(ball, 97);
  Warnings warnings;
  const auto lobes = bakeSweep(points.view(), coverageOf(ball, 80), sweepSettings(100, 1), warnings);
  std::vector<double> angles;
  for (size_t v = 0; v < lobes.size(); ++v) {
    angles.push_back(angleDegrees(lobes[v].direction, -points.normals[v]));
    EXPECT_NEAR(lobes[v].thickness, 1, 0.02);
  }
  std::sort(angles.begin(), angles.end());
  EXPECT_LT(angles[angles.size() / 2], 1);
}

// A lobe is the sum Σ ω ℓ² over both senses of all axes, whatever is left over in memory from one direction to the next: against the
// lengths of each axis alone, on a flat shape, where rays leave the field by its sides.
TEST(Sweep, LobesAreTheSumOfTheirLengths) {
  const SurfaceMesh torus = torusMesh(1, 0.2F, 96, 24);
  const CoverageField field = coverageOf(torus, 60);
  const size_t count = torus.positions.size();
  const auto axes = sweepAxes(200), senses = bothSenses(axes);
  for (const float ray_length : {0.15F, 0.6F, 1.5F, 4.0F}) {
    Warnings warnings;
    const auto lobes = bakeSweep({torus.positions, torus.normals}, field, sweepSettings(200, ray_length), warnings);
    const auto lengths = sweptLengths(torus.positions, axes, field, ray_length);
    double worst = 0;
    for (size_t v = 0; v < count; ++v) {
      double x = 0, y = 0, z = 0, squares = 0;
      for (size_t n = 0; n < senses.size(); ++n) {
        const double square = std::pow(double(lengths[n * count + v]), 2);
        x += square * senses[n].x, y += square * senses[n].y, z += square * senses[n].z, squares += square;
      }
      const double norm = std::sqrt(x * x + y * y + z * z);
      if (norm > 0.1 * squares)
        worst = std::max(worst, angleDegrees(lobes[v].direction, {float(x / norm), float(y / norm), float(z / norm)}));
    }
    EXPECT_LT(worst, 0.01) << ray_length;
  }
}

// Ball of radius R: o = inward normal, d = 2R at every vertex, whatever its size and place. Exact chords along the same 100 directions:
// median 0.3°.
TEST_P(BallAnywhere, HundredDirections) {
  const auto [center, radius] = GetParam();
  const SurfaceMesh ball = ballMesh(radius, 5, center);
  Warnings warnings;
  LevelSetSettings settings;
  const CoverageField field = coverageFromClosedMesh(ball, settings, warnings).value();
  const Points points = everyNth(ball, 5);
  const auto lobes = bakeSweep(points.view(), field, sweepSettings(100, boundingBox(ball).diagonal()), warnings);
  const BallFigures figures = ballFigures(lobes, points.positions, center, radius);
  std::printf("[figures] ball R=%g at (%g, %g, %g), 100 directions: median %.3f deg, p95 %.3f deg, density bias %.3f %%, worst %.3f %%\n",
              radius, center.x, center.y, center.z, figures.median, figures.p95, 100 * figures.density_bias, 100 * figures.density_worst);
  EXPECT_LT(figures.median, 0.5);
  EXPECT_LT(figures.p95, 1.2);
  EXPECT_LT(std::fabs(figures.density_bias), 0.003);
  EXPECT_LT(figures.density_worst, 0.02);
  EXPECT_TRUE(warnings.empty());
}
INSTANTIATE_TEST_SUITE_P(, BallAnywhere,
                         testing::Values(std::pair{Vec3{0, 0, 0}, 1.0F}, std::pair{Vec3{0, 0, 0}, 1e-6F}, std::pair{Vec3{0, 0, 0}, 1e6F},
                                         std::pair{Vec3{2000, 0, 0}, 1.0F}, std::pair{Vec3{-1154, 1154, 1154}, 1.0F}));

// The field from a level set finds the same ball.
TEST(Sweep, LevelSetFieldFindsTheBall) {
  Warnings warnings;
  const LevelSet level_set = levelSetFromSpheres(std::vector<Sphere>{{{0, 0, 0}, 1}}, {}, warnings);
  const SurfaceMesh mesh = meshFromLevelSet(level_set, {.vertices = 1000}, warnings);
  const auto lobes =
      bakeSweep({mesh.positions, mesh.normals}, coverageFromLevelSet(level_set, mesh.positions), sweepSettings(100, 4), warnings);
  const BallFigures figures = ballFigures(lobes, mesh.positions, {}, 1);
  std::printf("[figures] ball by level set, 100 directions: median %.3f deg, p95 %.3f deg, density bias %.3f %%, worst %.3f %%\n",
              figures.median, figures.p95, 100 * figures.density_bias, 100 * figures.density_worst);
  EXPECT_LT(figures.median, 0.5);
  EXPECT_LT(std::fabs(figures.density_bias), 0.005);
  EXPECT_TRUE(warnings.empty());
}

// Two balls through a gap, near each other and forty radii apart: against the union of the spheres' intervals.
TEST(Sweep, TwoBallsAgreeWithIntervals) {
  for (const float distance : {2.4F, 40.0F}) {
    const std::vector<Sphere> two{{{0, 0, 0}, 1}, {{distance, 0.3F, 0}, 0.7F}};
    const SurfaceMesh mesh = merged(ballMesh(1, 5), ballMesh(0.7F, 5, two[1].center));
    const Points points = everyNth(mesh, 41);
    Warnings warnings;
    const auto lobes =
        bakeSweep(points.view(), coverageOf(mesh, distance < 10 ? 150 : 800), sweepSettings(400, boundingBox(mesh).diagonal()), warnings);
    const LobeError error = compareLobes(lobes, trueLobes(*sphereReference(two), points.positions, fibonacciDirections(4096), INFINITY));
    std::printf("[figures] two balls %g apart, 400 directions: median %.3f deg, p95 %.3f deg, density rms %.3f %%, bias %.3f %%\n",
                double(distance), error.angle_median_degrees, error.angle_p95_degrees, 100 * error.density_rms, 100 * error.density_bias);
    EXPECT_LT(error.angle_median_degrees, 0.5);
    EXPECT_LT(error.angle_p95_degrees, 1.5);
    EXPECT_LT(std::fabs(error.density_bias), 0.01);
  }
}

// The centre of a ball sees as much on every side. Nothing in reach: −normal or −Y, d = 0, counted.
TEST(Sweep, UndefinedDirectionsAreFiniteAndCounted) {
  const SurfaceMesh ball = ballMesh(1, 5);
  LevelSetSettings settings;
  settings.voxels = 50;
  Warnings warnings;
  const std::vector<Vec3> centre{{0, 0, 0}}, normal{{1, 0, 0}};
  const auto lobes = bakeSweep({centre, normal}, coverageOf(ball, 50), sweepSettings(100, 3), warnings);
  expectFinite(lobes, 3);
  EXPECT_NEAR(lobes[0].thickness, 1, 0.02);

  Warnings far_warnings;
  const LevelSet level_set = levelSetFromSpheres(std::vector<Sphere>{{{0, 0, 0}, 1}}, settings, far_warnings);
  const std::vector<Vec3> far{{5, 0, 0}, {0, 0, -6}}, normals{{0, 0, 1}, {0, 1, 0}};
  const CoverageField field = coverageFromLevelSet(level_set, far);
  const auto with_normals = bakeSweep({far, normals}, field, sweepSettings(100, 0.5F), far_warnings);
  EXPECT_EQ(far_warnings.entries().at(WarningKind::kUndefinedDirection).count, 2U);
  EXPECT_EQ(with_normals[0].direction, (Vec3{0, 0, -1}));
  EXPECT_EQ(with_normals[1].direction, (Vec3{0, -1, 0}));
  EXPECT_EQ(with_normals[0].thickness, 0);
  EXPECT_EQ(bakeSweep({far, {}}, field, sweepSettings(100, 0.5F), far_warnings)[0].direction, (Vec3{0, -1, 0}));
}

// A vertex without a normal (vertexNormals gives zero where no triangle has an area) and without a direction: not a number must not come
// out.
TEST(Sweep, ZeroNormalIsFinite) {
  Warnings warnings;
  const LevelSet level_set = levelSetFromSpheres(std::vector<Sphere>{{{0, 0, 0}, 1}}, {}, warnings);
  const std::vector<Vec3> far{{5, 0, 0}}, normals{{0, 0, 0}};
  const auto lobes = bakeSweep({far, normals}, coverageFromLevelSet(level_set, far), sweepSettings(100, 0.5F), warnings);
  EXPECT_TRUE(isFinite(lobes[0].direction));
  EXPECT_EQ(lobes[0].thickness, 0);
}

// A cloud of one voxel and a sheet of a tenth of a voxel: nothing breaks, and directions point inwards on the single voxel.
TEST(Sweep, TinyAndThinCloudsAreFinite) {
  Warnings warnings;
  const SurfaceMesh ball = ballMesh(1, 3);
  const auto lobes = bakeSweep({ball.positions, ball.normals}, coverageOf(ball, 1), sweepSettings(100, 4), warnings);
  expectFinite(lobes, 8);
  double mean_cosine = 0;
  for (size_t v = 0; v < lobes.size(); ++v) mean_cosine -= double(dot(lobes[v].direction, ball.normals[v])) / double(lobes.size());
  EXPECT_GT(mean_cosine, 0.9);

  for (const float middle : {0.0F, 0.013F, 0.02F}) {
    const SurfaceMesh sheet = boxMesh({-1, middle - 0.002F, -1}, {1, middle + 0.002F, 1});
    const auto of_sheet =
        bakeSweep({sheet.positions, {}}, coverageFromMesh(sheet, {{0, 0, 0}, 0.04}).value(), sweepSettings(100, 3), warnings);
    expectFinite(of_sheet, 3);
  }
}

// Points outside the field's box are baked at its border, counted, finite, and look towards the cloud.
TEST(Sweep, PointsOutsideTheFieldAreCounted) {
  const SurfaceMesh ball = ballMesh(1, 5);
  const CoverageField field = coverageOf(ball, 50);
  Warnings warnings;
  const std::vector<Vec3> positions{{10, 0, 0}, {0, 1, 0}, {0, -1e6F, 0}, {3, 3, -3}}, normals{{1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
  const auto lobes = bakeSweep({positions, normals}, field, sweepSettings(200, 4), warnings);
  expectFinite(lobes, 4);
  EXPECT_EQ(warnings.entries().at(WarningKind::kOutsideField).count, 3U);
  EXPECT_LT(angleDegrees(lobes[0].direction, {-1, 0, 0}), 3);
  EXPECT_LT(angleDegrees(lobes[2].direction, {0, 1, 0}), 3);
}

// The same bytes for 1, 2 and 7 threads and for a second run, cut short or not.
TEST(Sweep, SameBytesForAnyThreadCount) {
  const SurfaceMesh cloud = dozenSpheres(40);
  const CoverageField field = coverageOf(cloud, 50);
  for (const float ray_length : {10.0F, 0.8F}) {
    const auto bake = [&] {
      Warnings warnings;
      return bakeSweep({cloud.positions, cloud.normals}, field, sweepSettings(150, ray_length), warnings);
    };
    const auto first = bake();
    for (const size_t threads : {1, 2, 7}) {
      const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      EXPECT_TRUE(sameBytes(first, bake())) << threads;
    }
  }
}

// A point's lobe depends on the point, not on its place in the list or on who else is in it.
TEST(Sweep, OrderOfVerticesDoesNotMatter) {
  const SurfaceMesh cloud = dozenSpheres(40);
  const CoverageField field = coverageOf(cloud, 50);
  std::vector<size_t> order(cloud.positions.size());
  std::iota(order.begin(), order.end(), size_t(0));
  for (size_t i = order.size(); i-- > 1;) std::swap(order[i], order[(i * 7919 + 13) % (i + 1)]);
  std::vector<Vec3> positions, normals;
  for (const size_t v : order) positions.push_back(cloud.positions[v]), normals.push_back(cloud.normals[v]);
  Warnings warnings;
  for (const float ray_length : {10.0F, 0.8F}) {
    const auto straight = bakeSweep({cloud.positions, cloud.normals}, field, sweepSettings(60, ray_length), warnings);
    const auto shuffled = bakeSweep({positions, normals}, field, sweepSettings(60, ray_length), warnings);
    const auto few =
        bakeSweep({std::span(positions).first(11), std::span(normals).first(11)}, field, sweepSettings(60, ray_length), warnings);
    for (size_t i = 0; i < order.size(); ++i) ASSERT_EQ(bitsOf(straight[order[i]]), bitsOf(shuffled[i])) << i;
    EXPECT_EQ(std::memcmp(few.data(), shuffled.data(), few.size() * sizeof(Lobe)), 0);
  }
}

// Scale by 2^10 and a shift that float holds: directions bit for bit, densities × 2^10.
TEST(Sweep, PowersOfTwoScaleExactly) {
  const SurfaceMesh torus = torusMesh(1, 0.4F, 64, 32);
  SurfaceMesh large = torus;
  for (Vec3& p : large.positions) p = p * 1024;
  Warnings warnings;
  const auto a = bakeSweep({torus.positions, torus.normals}, coverageOf(torus, 50), sweepSettings(60, 2), warnings);
  const auto b = bakeSweep({large.positions, large.normals}, coverageOf(large, 50), sweepSettings(60, 2048), warnings);
  for (size_t v = 0; v < a.size(); ++v) {
    ASSERT_EQ(a[v].direction, b[v].direction);
    ASSERT_EQ(a[v].thickness * 1024, b[v].thickness);
  }
}

// N/2 unit axes that stand for equal solid angles: Σ ωωᵀ is nearly (N/2)/3·I, and no two directions of the N come nearer than 0.75 of the
// mean spacing √(4π/N). (At the equator a Fibonacci set and its mirror image come as near as they like.)
TEST(SweepAxes, AreSpreadEvenly) {
  double nearest_ratio = INFINITY;
  for (int directions = 2; directions <= 400; directions += directions < 20 ? 2 : 6) {
    const auto axes = sweepAxes(directions);
    ASSERT_EQ(axes.size(), size_t(directions) / 2);
    double moments[3][3] = {}, nearest = INFINITY;
    for (size_t i = 0; i < axes.size(); ++i) {
      ASSERT_NEAR(length(axes[i]), 1, 1e-6);
      const double w[] = {axes[i].x, axes[i].y, axes[i].z};
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) moments[r][c] += w[r] * w[c];
      for (size_t j = 0; j < i; ++j) nearest = std::min({nearest, angleDegrees(axes[i], axes[j]), angleDegrees(axes[i], -axes[j])});
    }
    if (directions < 20) continue;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(moments[r][c] / double(axes.size()), r == c ? 1.0 / 3 : 0.0, 0.25 / directions) << directions;
    const double ratio = nearest * kPi / 180 / std::sqrt(4 * kPi / directions);
    nearest_ratio = std::min(nearest_ratio, ratio);
    EXPECT_GT(ratio, 0.75) << directions;
  }
  std::printf("[figures] sweep axes, N = 20 … 400: nearest pair at %.3f mean spacings\n", nearest_ratio);
}

// Many axes are not relaxed (the pairs are many): still unit and N/2 of them.
TEST(SweepAxes, ManyAxesToo) {
  const auto axes = sweepAxes(4096);
  ASSERT_EQ(axes.size(), 2048U);
  for (const Vec3& axis : axes) ASSERT_NEAR(length(axis), 1, 1e-6);
}

// The smallest sets still make lobes: on a ball with N = 2, 4, 6, finite and inwards.
TEST(SweepAxes, SmallestSetsBake) {
  const SurfaceMesh ball = ballMesh(1, 4);
  const CoverageField field = coverageOf(ball, 40);
  Warnings warnings;
  for (const int directions : {2, 4, 6}) {
    const auto lobes = bakeSweep({ball.positions, ball.normals}, field, sweepSettings(directions, 4), warnings);
    expectFinite(lobes, 4);
    double cosine = 0;
    for (size_t v = 0; v < lobes.size(); ++v) cosine -= double(dot(lobes[v].direction, ball.normals[v])) / double(lobes.size());
    EXPECT_GT(cosine, directions == 2 ? 0.4 : 0.7) << directions;
  }
}

// On a lumpy cloud, against 4096 exact directions: 100 swept directions are nearer to the truth than 100 stratified rays, in every figure.
TEST(Sweep, BeatsStratifiedRaysOnALumpyCloud) {
  const SurfaceMesh cloud = dozenSpheres(100);
  const Points points = everyNth(cloud, cloud.positions.size() / 400);
  const float diagonal = boundingBox(cloud).diagonal();
  Warnings warnings;
  LevelSetSettings level_set_settings;
  const DenseField dense = denseFromLevelSet(levelSetFromMesh(cloud, level_set_settings, warnings));
  const Truth truth = trueLobes(*meshReference(cloud), points.positions, fibonacciDirections(4096), INFINITY);
  BakeSettings ray_settings;
  ray_settings.ray_length = diagonal;
  const LobeError rays = compareLobes(bakeSphereRays(points.view(), dense, ray_settings, warnings), truth);
  const LobeError sweep = compareLobes(bakeSweep(points.view(), coverageOf(cloud, 100), sweepSettings(100, diagonal), warnings), truth);
  for (const auto& [name, error] : {std::pair{"stratified rays", &rays}, std::pair{"sweep", &sweep}})
    std::printf(
        "[figures] lumpy cloud, 100 directions, %s: rms %.3f deg, median %.3f deg, p95 %.3f deg, density rms %.3f %%, bias %.3f %%\n", name,
        error->angle_rms_degrees, error->angle_median_degrees, error->angle_p95_degrees, 100 * error->density_rms,
        100 * error->density_bias);
  EXPECT_LT(sweep.angle_rms_degrees, rays.angle_rms_degrees);
  EXPECT_LT(sweep.angle_median_degrees, rays.angle_median_degrees);
  EXPECT_LT(sweep.angle_p95_degrees, rays.angle_p95_degrees);
  EXPECT_LT(sweep.density_rms, 0.05);
}

// One number for all that a sweep computes: tests/cli/same_under_tunables compares it between glibc's variants of the maths functions.
TEST(Sweep, PrintsItsHash) {
  const SurfaceMesh torus = torusMesh(1, 0.4F, 64, 32);
  const CoverageField field = coverageOf(torus, 40);
  Warnings warnings;
  for (const float ray_length : {4.0F, 0.7F}) {
    const auto lobes = bakeSweep({torus.positions, torus.normals}, field, sweepSettings(200, ray_length), warnings);
    const auto lengths = sweptLengths(torus.positions, sweepAxes(40), field, ray_length);
    const uint64_t hash = hashOf(lengths.data(), lengths.size() * sizeof(float), hashOf(lobes.data(), lobes.size() * sizeof(Lobe)));
    std::printf("[hash] sweep-torus-%g %016llx\n", double(ray_length), static_cast<unsigned long long>(hash));
    for (const Lobe& lobe : lobes) ASSERT_TRUE(isFinite(lobe.direction));
  }
}

// Many points are baked in blocks, which changes none of them.
TEST(Sweep, BakesManyPointsAsFew) {
  const SurfaceMesh mesh = torusMesh(1, 0.4F, 700, 400);
  const CoverageField field = coverageFromMesh(mesh, {{0, 0, 0}, 0.1}).value();
  Warnings warnings;
  const std::vector<Lobe> all = bakeSweep({mesh.positions, mesh.normals}, field, sweepSettings(16, 4), warnings);
  for (const size_t first : {size_t(0), mesh.positions.size() / 2 - 50, mesh.positions.size() - 100}) {
    const auto positions = std::span(mesh.positions).subspan(first, 100), normals = std::span(mesh.normals).subspan(first, 100);
    const std::vector<Lobe> some = bakeSweep({positions, normals}, field, sweepSettings(16, 4), warnings);
    for (size_t i = 0; i < some.size(); ++i)
      EXPECT_TRUE(some[i].direction == all[first + i].direction && some[i].thickness == all[first + i].thickness);
  }
}
