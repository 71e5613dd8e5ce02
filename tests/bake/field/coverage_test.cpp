#include "bake/field/coverage.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "bake/mesh/mesh_topology.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

// A lattice of this voxel size whose origin lies at the given share of a voxel.
GridFrame frameAt(double voxel_size, Vec3 offset_voxels) {
  return {{offset_voxels.x * voxel_size, offset_voxels.y * voxel_size, offset_voxels.z * voxel_size}, voxel_size};
}

GridFrame centredFrame(const SurfaceMesh& mesh, int voxels) {
  LevelSetSettings settings;
  settings.voxels = voxels;
  return frameFor(boundingBox(mesh), settings);
}

double volumeOf(const CoverageField& field) {
  double cells = 0;
  for (const float fraction : field.fractions) cells += double(fraction);
  return cells * std::pow(field.frame.voxel_size, 3);
}

float fractionAt(const CoverageField& field, int i, int j, int k) {
  const int x = i - field.first[0], y = j - field.first[1], z = k - field.first[2];
  if (x < 0 || y < 0 || z < 0 || x >= field.cells[0] || y >= field.cells[1] || z >= field.cells[2]) return 0;
  return field.fractions[(size_t(z) * size_t(field.cells[1]) + size_t(y)) * size_t(field.cells[0]) + size_t(x)];
}

// All fractions lie in [0, 1] and the outermost two cells on every side are 0.
void expectWellFormed(const CoverageField& field) {
  ASSERT_EQ(field.fractions.size(), size_t(field.cells[0]) * size_t(field.cells[1]) * size_t(field.cells[2]));
  size_t at = 0, outside_range = 0, filled_border = 0;
  for (int k = 0; k < field.cells[2]; ++k)
    for (int j = 0; j < field.cells[1]; ++j)
      for (int i = 0; i < field.cells[0]; ++i) {
        const float fraction = field.fractions[at++];
        outside_range += !(fraction >= 0 && fraction <= 1);
        const int border = std::min({i, j, k, field.cells[0] - 1 - i, field.cells[1] - 1 - j, field.cells[2] - 1 - k});
        filled_border += border < 2 && fraction != 0;
      }
  EXPECT_EQ(outside_range, 0U);
  EXPECT_EQ(filled_border, 0U);
}

bool sameBytes(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

// Root mean square over many offsets of the lattice of the relative error in volume, at `voxels` per unit.
double volumeError(const SurfaceMesh& mesh, double truth, double voxels) {
  constexpr int kOffsets = 32;
  double squares = 0;
  for (int n = 0; n < kOffsets; ++n) {
    const auto part = [&](double step) { return float(n * step - std::floor(n * step)); };  // (0, 0, 0) first; an additive recurrence
    const auto field = coverageFromMesh(mesh, frameAt(1 / voxels, {part(0.8191725134), part(0.6710436067), part(0.5497004779)}));
    EXPECT_TRUE(field.has_value());
    if (!field) return INFINITY;
    expectWellFormed(*field);
    squares += std::pow(volumeOf(*field) / truth - 1, 2);
  }
  return std::sqrt(squares / kOffsets);
}

}  // namespace

// The fractions of a ball and of a torus add up to 4πR³/3 and 2π²Rr² (less what the facets cut off), wherever the lattice lies. Each axis
// adds up columns of exact length over a square lattice, which converges as h²; as h^1.5 where the outline of the shape runs along the
// lattice, as the torus's does.
TEST(Coverage, VolumeConvergesToTheClosedForm) {
  const SurfaceMesh ball = ballMesh(1, 6), torus = torusMesh(1, 0.4F, 512, 256);
  const struct {
    const char* name;
    const SurfaceMesh& mesh;
    double truth, order;
  } shapes[] = {{"ball", ball, 4 * kPi / 3, 2}, {"torus", torus, 2 * kPi * kPi * 0.4 * 0.4, 1.5}};
  for (const auto& [name, mesh, truth, order] : shapes) {
    const double of_facets = signedVolume(mesh);
    EXPECT_NEAR(of_facets / truth, 1, 5e-4);
    const double coarse = volumeError(mesh, of_facets, 10), fine = volumeError(mesh, of_facets, 40);
    const double slope = std::log(coarse / fine) / std::log(4.0);
    std::printf("[figures] %s: rms volume error %.4f %% at 10, %.4f %% at 40 voxels per R, slope %.2f\n", name, 100 * coarse, 100 * fine,
                slope);
    EXPECT_LT(coarse, 0.015);
    EXPECT_LT(fine, 0.002);
    EXPECT_GT(slope, order - 0.2);
  }
}

// A box whose faces are the borders of cells fills them with exactly 1 and all others with exactly 0.
TEST(Coverage, BoxOnCellBordersIsExact) {
  const auto field = coverageFromMesh(boxMesh({-3.5F, -1.5F, -0.5F}, {2.5F, 4.5F, 6.5F}), GridFrame{}).value();
  expectWellFormed(field);
  size_t wrong = 0;
  for (int k = -6; k <= 12; ++k)
    for (int j = -6; j <= 12; ++j)
      for (int i = -6; i <= 12; ++i) {
        const bool inside = i >= -3 && i <= 2 && j >= -1 && j <= 4 && k >= 0 && k <= 6;
        wrong += fractionAt(field, i, j, k) != (inside ? 1.0F : 0.0F);
      }
  EXPECT_EQ(wrong, 0U);
  EXPECT_EQ(volumeOf(field), 6 * 6 * 7);
}

// Faces through the centres of cells: the line across the face sees ½ on either side, those along it lie on the face and belong to one side
// only. Opposite faces make up a whole cell, and the volume is exact.
TEST(Coverage, BoxThroughCellCentresIsExactInSum) {
  const auto field = coverageFromMesh(boxMesh({-3, -4, -5}, {3, 4, 5}), GridFrame{}).value();
  expectWellFormed(field);
  EXPECT_NEAR(volumeOf(field), 6 * 8 * 10, 1e-3);
  EXPECT_EQ(fractionAt(field, 0, 0, 0), 1);
  for (const float low : {fractionAt(field, -3, 0, 0), fractionAt(field, 0, -4, 0), fractionAt(field, 0, 0, -5)})
    EXPECT_TRUE(std::fabs(low - 1.0F / 6) < 1e-6F || std::fabs(low - 5.0F / 6) < 1e-6F || std::fabs(low - 0.5F) < 1e-6F) << low;
  EXPECT_NEAR(fractionAt(field, -3, 0, 0) + fractionAt(field, 3, 0, 0), 1, 1e-6);
  EXPECT_NEAR(fractionAt(field, 0, -4, 0) + fractionAt(field, 0, 4, 0), 1, 1e-6);
  EXPECT_NEAR(fractionAt(field, 0, 0, -5) + fractionAt(field, 0, 0, 5), 1, 1e-6);
}

// A face anywhere in a cell is right in the mean over where it lies, and never off by more than a third of a cell.
TEST(Coverage, FaceInsideACellIsRightInTheMean) {
  constexpr int kPlaces = 64;
  for (const int axis : {0, 1, 2}) {
    double sum = 0;
    for (int n = 0; n < kPlaces; ++n) {
      float high[3] = {4.5F, 4.5F, 4.5F};
      high[axis] = 3.5F + (float(n) + 0.5F) / kPlaces;
      const auto field = coverageFromMesh(boxMesh({-4.5F, -4.5F, -4.5F}, {high[0], high[1], high[2]}), GridFrame{}).value();
      const double cells = volumeOf(field) / 81, truth = double(high[axis]) + 4.5;
      EXPECT_NEAR(cells, truth, 0.334) << axis << ' ' << n;
      sum += cells - truth;
    }
    EXPECT_NEAR(sum / kPlaces, 0, 1e-4) << axis;
  }
}

// A plane x + y + z = c cuts a cube of cells: the mean over many cells is the cut volume, and each fraction falls with the distance.
TEST(Coverage, SlopedFaceIsRightInTheMean) {
  // A tetrahedron of legs a: volume a³/6.
  const float a = 40.3F;
  SurfaceMesh corner;
  corner.positions = {{-0.5F, -0.5F, -0.5F}, {a - 0.5F, -0.5F, -0.5F}, {-0.5F, a - 0.5F, -0.5F}, {-0.5F, -0.5F, a - 0.5F}};
  corner.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const auto field = coverageFromMesh(corner, GridFrame{}).value();
  expectWellFormed(field);
  EXPECT_NEAR(volumeOf(field) / (std::pow(double(a), 3) / 6), 1, 0.002);
  for (int i = 0; i < 12; ++i)
    for (int k = -2; k < 40; ++k) EXPECT_GE(fractionAt(field, i, 5, k + (k >= 0 ? 0 : 2)), fractionAt(field, i, 5, std::max(k, 0) + 1));
}

// Overlapping balls count once: the lens of two unit balls whose centres are 1 apart has volume 5π/12. So do coincident ones.
TEST(Coverage, OverlapsCountOnce) {
  const SurfaceMesh two = merged(ballMesh(1, 5), ballMesh(1, 5, {1, 0, 0}));
  const auto field = coverageFromMesh(two, centredFrame(two, 60)).value();
  expectWellFormed(field);
  EXPECT_NEAR(volumeOf(field) / (8 * kPi / 3 - 5 * kPi / 12), 1, 0.003);
  const SurfaceMesh ball = ballMesh(1, 4), twice = merged(ball, ball);
  EXPECT_TRUE(
      sameBytes(coverageFromMesh(ball, centredFrame(ball, 40))->fractions, coverageFromMesh(twice, centredFrame(ball, 40))->fractions));
}

// A reversed inner shell is a cavity, one that faces outwards counts once, and a mesh inside out is the same solid, byte for byte.
TEST(Coverage, CavityAndInversionFollowTheWindingNumber) {
  const SurfaceMesh outer = ballMesh(1, 5);
  SurfaceMesh inner = ballMesh(0.5F, 5);
  const GridFrame frame = centredFrame(outer, 50);
  const auto solid = coverageFromMesh(outer, frame).value();
  EXPECT_TRUE(sameBytes(solid.fractions, coverageFromMesh(merged(outer, inner), frame)->fractions));
  reverse(inner);
  const auto hollow = coverageFromMesh(merged(outer, inner), frame).value();
  expectWellFormed(hollow);
  EXPECT_EQ(fractionAt(hollow, 0, 0, 0), 0);
  EXPECT_EQ(fractionAt(solid, 0, 0, 0), 1);
  EXPECT_NEAR(volumeOf(hollow) / (4 * kPi / 3 * 7 / 8), 1, 0.003);
  SurfaceMesh inverted = outer;
  reverse(inverted);
  EXPECT_TRUE(sameBytes(solid.fractions, coverageFromMesh(inverted, frame)->fractions));
}

// One triangle less, if any column passes through it, and there is no field: whichever axis the column lies along.
TEST(Coverage, OpenMeshGivesNothing) {
  const SurfaceMesh box = boxMesh({-3.2F, -3.2F, -3.2F}, {3.2F, 3.2F, 3.2F}), ball = ballMesh(6, 1);
  for (const SurfaceMesh* mesh : {&box, &ball})
    for (size_t t = 0; t < mesh->triangles.size(); ++t) {
      SurfaceMesh open = *mesh;
      open.triangles.erase(open.triangles.begin() + ptrdiff_t(t));
      EXPECT_FALSE(coverageFromMesh(open, GridFrame{}).has_value()) << t;
    }
  Warnings warnings;
  SurfaceMesh half = ballMesh(1, 4);
  std::erase_if(half.triangles, [&](const Triangle& t) { return half.positions[t[0]].y < 0; });
  EXPECT_FALSE(coverageFromClosedMesh(half, {}, warnings).has_value());
}

// Vertices on lattice corners put hundreds of edges and vertices onto columns: still closed, in range, and of the polyhedron's volume in
// the mean.
TEST(Coverage, VerticesOnLatticeCorners) {
  double ratio = 0;
  constexpr int kBalls = 20;
  for (int n = 0; n < kBalls; ++n) {
    SurfaceMesh ball = ballMesh(9 + 0.37F * float(n), 3);
    const float step = n % 2 ? 2.0F : 1.0F;
    for (Vec3& p : ball.positions) p = {std::round(step * p.x) / step, std::round(step * p.y) / step, std::round(step * p.z) / step};
    const auto field = coverageFromMesh(ball, GridFrame{});
    ASSERT_TRUE(field.has_value()) << n;
    expectWellFormed(*field);
    EXPECT_NEAR(volumeOf(*field) / signedVolume(ball), 1, 0.01) << n;
    ratio += volumeOf(*field) / signedVolume(ball) / kBalls;
  }
  EXPECT_NEAR(ratio, 1, 0.002);
}

// Scales by powers of two and, where the positions stay exact, translations: the frame moves along, and the field keeps its bytes.
TEST(Coverage, ScaleAndTranslationKeepTheBytes) {
  SurfaceMesh torus = torusMesh(1, 0.4F, 64, 32);
  for (Vec3& p : torus.positions) p = {std::round(p.x * 4096) / 4096, std::round(p.y * 4096) / 4096, std::round(p.z * 4096) / 4096};
  const auto field = coverageFromMesh(torus, centredFrame(torus, 50)).value();
  const auto moved = [&](float scale, Vec3 shift) {
    SurfaceMesh mesh = torus;
    for (Vec3& p : mesh.positions) p = p * scale + shift;
    return coverageFromMesh(mesh, centredFrame(mesh, 50)).value();
  };
  for (const auto& [scale, shift] :
       {std::pair{1024.0F, Vec3{}}, std::pair{1.0F / 1048576, Vec3{}}, std::pair{1.0F, Vec3{1000, -500, 250}}}) {
    const auto other = moved(scale, shift);
    EXPECT_EQ(field.first, other.first);
    EXPECT_EQ(field.cells, other.cells);
    EXPECT_TRUE(sameBytes(field.fractions, other.fractions)) << scale << ' ' << shift.x;
  }
}

// Fractions from the distance and from the triangles of one ball: the same lattice, the same volume, the same cells but for a blur at the
// surface.
TEST(Coverage, LevelSetAndMeshAgreeOnABall) {
  const SurfaceMesh ball = ballMesh(1, 6);
  Warnings warnings;
  LevelSetSettings settings;
  settings.voxels = 60;
  const LevelSet level_set = levelSetFromSpheres(std::vector<Sphere>{{{0, 0, 0}, 1}}, settings, warnings);
  const auto by_distance = coverageFromLevelSet(level_set);
  const auto by_mesh = coverageFromMesh(ball, level_set.frame).value();
  expectWellFormed(by_distance);
  EXPECT_NEAR(volumeOf(by_distance) / (4 * kPi / 3), 1, 0.002);
  double squares = 0, worst = 0;
  int surface_cells = 0;
  for (int k = -33; k <= 33; ++k)
    for (int j = -33; j <= 33; ++j)
      for (int i = -33; i <= 33; ++i) {
        const double a = fractionAt(by_distance, i, j, k), b = fractionAt(by_mesh, i, j, k);
        const double phi = std::sqrt(double(i * i + j * j + k * k)) - 30;
        if (std::fabs(phi) > 0.9) {
          ASSERT_EQ(a, b) << i << ' ' << j << ' ' << k;
          continue;
        }
        squares += (a - b) * (a - b), worst = std::max(worst, std::fabs(a - b));
        ++surface_cells;
      }
  std::printf("[figures] ball, fractions of surface cells, level set against mesh: rms %.4f, worst %.4f\n",
              std::sqrt(squares / surface_cells), worst);
  EXPECT_LT(std::sqrt(squares / surface_cells), 0.13);
  EXPECT_LT(worst, 0.4);
}

// A field from a level set reaches around the points that are given, however far outside they lie, and is empty for an empty band.
TEST(Coverage, LevelSetFieldReachesThePoints) {
  Warnings warnings;
  LevelSetSettings settings;
  settings.voxels = 20;
  const LevelSet level_set = levelSetFromSpheres(std::vector<Sphere>{{{0, 0, 0}, 1}}, settings, warnings);
  const Vec3 points[] = {{4.03F, 0, 0}, {0, -2.5F, 0.1F}};
  const auto plain = coverageFromLevelSet(level_set), wide = coverageFromLevelSet(level_set, points);
  expectWellFormed(wide);
  EXPECT_DOUBLE_EQ(volumeOf(wide), volumeOf(plain));
  for (const Vec3& p : points) {
    const Vec3 index = wide.frame.toIndex(p);
    const float at[3] = {index.x, index.y, index.z};
    for (size_t a = 0; a < 3; ++a) {
      EXPECT_GE(at[a], float(wide.first[a] + 2));
      EXPECT_LE(at[a], float(wide.first[a] + wide.cells[a] - 3));
    }
  }
}

// A face across x at any height in its cell: of the three lines through the cell's centre, the one along x is cut at the face, to 2⁻¹² of a
// cell, and the two along the face are inside or outside.
TEST(Coverage, AFaceCutsItsCellsAtItsHeight) {
  for (int n = 0; n < 50; ++n) {
    const float share = (float(n) + 0.5F) / 50;
    const auto field = coverageFromMesh(boxMesh({-3.5F, -3.5F, -3.5F}, {2.5F + share, 2.5F, 2.5F}), GridFrame{}).value();
    const double expected = (share + (share > 0.5F ? 2 : 0)) / 3;
    EXPECT_NEAR(fractionAt(field, 3, 0, 0), expected, 0x1p-12 / 3) << share;
    EXPECT_EQ(fractionAt(field, 2, 0, 0), 1);
    EXPECT_EQ(fractionAt(field, 4, 0, 0), 0);
  }
}

// Fractions of a plane whose distance is known: ½ − φ, 1 from half a voxel below it and 0 from half a voxel above it.
TEST(Coverage, LevelSetFractionsFallAcrossTheSurface) {
  Warnings warnings;
  for (const float height : {0.0F, 0.2F, 0.45F, 0.5F, 0.7F}) {
    LevelSetSettings settings;
    settings.voxel_size = 1.0F;
    settings.flat_base = -20 + height;  // the box of the half ball ends at the base, and its centre is the lattice's origin
    const LevelSet ball = levelSetFromSpheres(std::vector<Sphere>{{{0, 0, 0}, 30}}, settings, warnings);
    const CoverageField field = coverageFromLevelSet(ball);
    const double base = (-20.0 + height - ball.frame.origin[1]);
    for (int j = -32; j < 0; ++j)
      EXPECT_NEAR(fractionAt(field, 0, j, 0), std::clamp(0.5 + (j - base), 0.0, 1.0), 1e-5) << height << ' ' << j;
  }
}

// A sheet of a fifth of a voxel between two layers of cell centres: only the lines across it meet it, so that the field holds a third of
// its volume, and that is counted.
TEST(Coverage, LostVolumeIsCounted) {
  LevelSetSettings settings;
  settings.voxel_size = 1.0F;
  const SurfaceMesh corner = boxMesh({0, 30, 0}, {1, 31, 1});  // moves the origin, the centre of the box, away from the sheet
  const SurfaceMesh sheet = merged(boxMesh({-20, 0.4F, -20}, {20, 0.6F, 20}), corner);
  Warnings warnings;
  const auto field = coverageFromClosedMesh(sheet, settings, warnings);
  ASSERT_TRUE(field.has_value());
  ASSERT_TRUE(warnings.entries().contains(WarningKind::kVolumeMismatch));
  EXPECT_NEAR(volumeOf(*field), 40 * 40 * 0.2 / 3 + 1, 2);
  Warnings none;
  ASSERT_TRUE(coverageFromClosedMesh(merged(boxMesh({-20, -1.4F, -20}, {20, 0.6F, 20}), corner), settings, none).has_value());
  EXPECT_TRUE(none.empty());
}

// The estimate is an upper bound: four copies of the cells and, per thread, two planes of a shear by up to 45° along both axes.
TEST(Coverage, TheEstimateHoldsTheFieldAndItsSweep) {
  for (const Vec3 size : {Vec3{40, 40, 40}, Vec3{100, 10, 3}, Vec3{5, 90, 20}}) {
    const SurfaceMesh box = boxMesh(size * -0.5F, size * 0.5F);
    const CoverageField field = coverageFromMesh(box, GridFrame{}).value();
    const auto [x, y, z] = field.cells;
    double planes = 0;
    for (const auto& [a, b, c] : {std::array{x, y, z}, std::array{y, z, x}, std::array{z, x, y}})
      planes = std::max(planes, 2.0 * (a + c) * (b + c));
    const double cells = double(field.fractions.size());
    const double bytes = estimateCoverageBytes(boundingBox(box), 1);
    EXPECT_GE(bytes, sizeof(float) * (4 * cells + planes));
    EXPECT_LE(bytes, sizeof(float) * (4 * cells + planes * tbb::this_task_arena::max_concurrency()) * 2);
  }
}

// What the field is made of is checked and counted on the way.
TEST(Coverage, ClosedMeshCountsWhatIsOdd) {
  Warnings warnings;
  SurfaceMesh ball = ballMesh(1, 4);
  ASSERT_TRUE(coverageFromClosedMesh(ball, {}, warnings).has_value());
  EXPECT_TRUE(warnings.empty());
  reverse(ball);
  ASSERT_TRUE(coverageFromClosedMesh(ball, {}, warnings).has_value());
  EXPECT_TRUE(warnings.entries().contains(WarningKind::kInvertedMesh));
  LevelSetSettings absurd;
  absurd.voxels = 1000000000;
  EXPECT_ANY_THROW(coverageFromClosedMesh(ball, absurd, warnings));
  EXPECT_ANY_THROW(coverageFromClosedMesh({}, {}, warnings));
}
