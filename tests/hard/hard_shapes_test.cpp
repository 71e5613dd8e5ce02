// Shapes that break bakers, through the whole pipeline. docs/numerics.md lists every hard case.
#include <gtest/gtest.h>

#include <numeric>

#include "bake/field/thin_parts.h"
#include "bake/truth/reference.h"
#include "core/random.h"
#include "tests/bake/both_bakes.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

double fieldVolume(const CoverageField& field) {
  return std::accumulate(field.fractions.begin(), field.fractions.end(), 0.0) * std::pow(field.frame.voxel_size, 3);
}

LevelSetSettings voxelsOf(float size) {
  LevelSetSettings settings;
  settings.voxel_size = size;
  return settings;
}

// Lobes of both methods along a given direction: d = ℓ there.
struct Chord {
  float swept, marched;
};
Chord chordOf(const SurfaceMesh& solid, Vec3 from, Vec3 along, int voxels) {
  Warnings warnings;
  BakeSettings settings;
  settings.steps = 400;
  settings.ray_length = boundingBox(solid).diagonal();
  const auto coverage = coverageFromClosedMesh(solid, latticeOf(voxels), warnings).value();
  const DenseField dense = denseFromLevelSet(levelSetFromMesh(solid, latticeOf(voxels), warnings));
  return {sweptLengths({&from, 1}, {&along, 1}, coverage, 1e9)[0], marchedLengths({&from, 1}, {&along, 1}, dense, settings)[0]};
}

}  // namespace

// At one voxel along the longest side no slice has a neighbour: corners still look at the middle, and no thickness is lost or made up
// beyond the size of a voxel.
TEST(HardShapes, ASingleVoxel) {
  const SurfaceMesh cube = boxMesh({-1, -1, -1}, {1, 1, 1});
  const BothBakes bakes = bakedBothWays(cube, {cube.positions, {}}, latticeOf(1));
  for (size_t v = 0; v < 8; ++v)
    for (const Lobe& lobe : {bakes.sweep[v], bakes.rays[v]}) {
      EXPECT_LT(angleDegrees(lobe.direction, *normalized(-cube.positions[v])), 12);
      EXPECT_GT(lobe.thickness, 0.4 * 2 * std::sqrt(3.0));
      EXPECT_LT(lobe.thickness, 2.5 * 2 * std::sqrt(3.0));
    }
}

// A sheet of a fifth of a voxel falls between the lattice's lines or fills a whole one of them: right in the mean over its places, and
// told.
TEST(HardShapes, ASheetThinnerThanAVoxel) {
  constexpr int kPlaces = 200;
  double sum = 0;
  for (int n = 0; n < kPlaces; ++n) {
    const float y = (float(n) + 0.5F) / kPlaces;
    SurfaceMesh sheet = boxMesh({-10, y - 0.1F, -10}, {10, y + 0.1F, 10});
    const CoverageField field = coverageFromMesh(sheet, GridFrame{}).value();
    sum += fieldVolume(field) / kPlaces;
    for (const Vec3& p : sheet.positions) sheet.normals.push_back({0, p.y > y ? 1.0F : -1.0F, 0});
    EXPECT_EQ(findThinParts({sheet.positions, sheet.normals}, field).count, 8U) << n;
  }
  EXPECT_NEAR(sum / (20 * 20 * 0.2), 1, 0.01);
}

// A shell inside a shell that faces the same way adds nothing: winding 2 is inside as much as 1, and no bit of a lobe may change.
TEST(HardShapes, NestedShells) {
  const SurfaceMesh ball = ballMesh(1, 4), inner = ballMesh(0.5F, 4);
  const BothBakes solid = bakedBothWays(ball, 60);
  const BothBakes nested = bakedBothWays(merged(ball, inner), {ball.positions, ball.normals}, latticeOf(60));
  EXPECT_TRUE(sameBytes(solid.sweep, nested.sweep));
  for (size_t v = 0; v < ball.positions.size(); ++v) {
    ASSERT_LT(angleDegrees(solid.rays[v].direction, nested.rays[v].direction), 0.1);
    ASSERT_NEAR(nested.rays[v].thickness, solid.rays[v].thickness, 0.01);
  }
}

// A shell that faces inwards is a cavity, which a flood from outside fills: through it d = 2 (R − r), and o is still the inward normal.
TEST(HardShapes, ACavity) {
  const SurfaceMesh ball = ballMesh(1, 5);
  SurfaceMesh inner = ballMesh(0.5F, 5);
  reverse(inner);
  const BothBakes bakes = bakedBothWays(merged(ball, inner), {ball.positions, ball.normals}, latticeOf(80));
  std::vector<Lobe> truth;
  for (const Vec3& n : ball.normals) truth.push_back({-n, 1});
  EXPECT_LT(anglesBetween(bakes.sweep, truth).median, 1);
  EXPECT_LT(anglesBetween(bakes.rays, truth).median, 1.5);
  for (const auto* lobes : {&bakes.sweep, &bakes.rays}) {
    double mean = 0;
    for (const Lobe& lobe : *lobes) mean += double(lobe.thickness) / double(lobes->size());
    EXPECT_NEAR(mean, 1, 0.02);
  }
}

// The same shell twice in place has winding 2 and every triangle twice: still closed, and the same lobes to the bit.
TEST(HardShapes, AShellTwice) {
  const SurfaceMesh ball = ballMesh(1, 4), twice = merged(ball, ball);
  EXPECT_EQ(findDefects(twice).unmatched_edges, 0U);
  EXPECT_EQ(findDefects(twice).duplicate_triangles.count, ball.triangles.size());
  const BothBakes once = bakedBothWays(ball, 50), both = bakedBothWays(twice, {ball.positions, ball.normals}, latticeOf(50));
  EXPECT_TRUE(sameBytes(once.sweep, both.sweep));
  EXPECT_TRUE(sameBytes(once.rays, both.rays));
}

// A shell and its own image inside out cancel: closed, and nothing is inside. Every vertex is told to have no direction, and d is 0.
TEST(HardShapes, AShellCancelledByItsImage) {
  const SurfaceMesh ball = ballMesh(1, 3);
  SurfaceMesh image = ball;
  reverse(image);
  const BothBakes bakes = bakedBothWays(merged(ball, image), {ball.positions, ball.normals}, latticeOf(40));
  for (const auto& [lobes, warnings] : {std::pair{&bakes.sweep, &bakes.sweep_warnings}, {&bakes.rays, &bakes.rays_warnings}}) {
    EXPECT_EQ(countOf(*warnings, WarningKind::kUndefinedDirection), ball.positions.size());
    for (size_t v = 0; v < lobes->size(); ++v) {
      ASSERT_EQ((*lobes)[v].direction, -ball.normals[v]);
      ASSERT_EQ((*lobes)[v].thickness, 0);
    }
  }
}

// A sheet with a back has no open edge, and still holds nothing: no volume is made up for it.
TEST(HardShapes, ADoubleSidedSheet) {
  const SurfaceMesh sheet{{{0, 0, 0}, {1, 0, 0}, {1, 0.3F, 1}, {0, 0.3F, 1}}, {}, {{0, 1, 2}, {0, 2, 3}, {2, 1, 0}, {3, 2, 0}}};
  EXPECT_EQ(findDefects(sheet).unmatched_edges, 0U);
  Warnings warnings;
  EXPECT_EQ(fieldVolume(coverageFromClosedMesh(sheet, latticeOf(50), warnings).value()), 0);
  const std::vector<Lobe> lobes = sweptLobes(sheet, {sheet.positions, {}}, latticeOf(50), warnings);
  EXPECT_EQ(countOf(warnings, WarningKind::kUndefinedDirection), 4U);
  for (const Lobe& lobe : lobes) EXPECT_EQ(lobe.direction, (Vec3{0, -1, 0}));
}

// Two clouds a thousand radii apart leave a tenth of a voxel to each: every vertex is told to be on a thin part; with voxels enough for
// one, each alone bakes as a ball.
TEST(HardShapes, TwoCloudsFarApart) {
  const SurfaceMesh near = ballMesh(1, 3), both = merged(near, ballMesh(1, 3, {1000, 300, 0}));
  Warnings warnings;
  const CoverageField field = coverageFromClosedMesh(both, latticeOf(100), warnings).value();
  EXPECT_EQ(findThinParts({both.positions, both.normals}, field).count, both.positions.size());
  const std::vector<Sphere> spheres{{{0, 0, 0}, 1}, {{30, 0, 0}, 1}};
  const SurfaceMesh pair = merged(near, ballMesh(1, 3, {30, 0, 0}));
  const BothBakes bakes = bakedBothWays(pair, 800, 400);
  std::vector<Vec3> directions;
  for (const Vec3& axis : sweepAxes(2000)) directions.insert(directions.end(), {axis, -axis});
  const Truth truth = trueLobes(*sphereReference(spheres), pair.positions, directions, INFINITY);
  EXPECT_LT(anglesBetween(bakes.sweep, truth.lobes).median, 1);
  EXPECT_LT(anglesBetween(bakes.rays, truth.lobes).median, 1.5);
}

// One vertex a thousand radii away stretches the box until a voxel is as wide as ten balls: nothing overflows, and all is told to be thin.
TEST(HardShapes, AnOutlier) {
  SurfaceMesh mesh = ballMesh(1, 3);
  mesh.positions[100] = mesh.positions[100] * 1000;
  const BothBakes bakes = bakedBothWays(mesh, 100);
  Warnings warnings;
  const CoverageField field = coverageFromClosedMesh(mesh, latticeOf(100), warnings).value();
  EXPECT_GT(findThinParts({mesh.positions, mesh.normals}, field).count, mesh.positions.size() * 9 / 10);
  for (const auto* lobes : {&bakes.sweep, &bakes.rays})
    for (const Lobe& lobe : *lobes) {
      ASSERT_NEAR(length(lobe.direction), 1, 1e-5);
      ASSERT_LT(std::fabs(lobe.thickness), boundingBox(mesh).diagonal());
    }
}

// A needle of 1000:1 is a tenth of a voxel thick where the longest side gets a hundred: told; with voxels finer than it, its ends are
// exact.
TEST(HardShapes, ANeedle) {
  const SurfaceMesh needle = boxMesh({-0.5F, -500, -0.5F}, {0.5F, 500, 0.5F});
  std::vector<Vec3> normals;
  for (const Vec3& p : needle.positions) normals.push_back(*normalized({p.x, 0, p.z}));
  Warnings warnings;
  EXPECT_EQ(findThinParts({needle.positions, normals}, coverageFromClosedMesh(needle, latticeOf(100), warnings).value()).count, 8U);
  const std::vector<Vec3> ends{{0, -500, 0}, {0, 500, 0}}, outwards{{0, -1, 0}, {0, 1, 0}};
  const std::vector<Lobe> lobes = sweptLobes(needle, {ends, outwards}, latticeOf(4000), warnings);
  for (size_t v = 0; v < 2; ++v) EXPECT_LT(angleDegrees(lobes[v].direction, -outwards[v]), 3);
  const Chord along = chordOf(needle, ends[0], {0, 1, 0}, 4000);
  EXPECT_NEAR(along.swept, 1000, 20);
  EXPECT_NEAR(along.marched, 1000, 1);
}

// The wall between two boxes that share a face is there twice, once each way: no gap opens there, whatever cell it lies in.
TEST(HardShapes, TwoBoxesThatShareAFace) {
  for (const float wall : {0.0F, 0.013F, 0.1F}) {
    const SurfaceMesh boxes = merged(boxMesh({-1, -1, -1}, {wall, 1, 1}), boxMesh({wall, -1, -1}, {1, 1, 1}));
    EXPECT_EQ(findDefects(boxes).unmatched_edges, 0U);
    const Chord chord = chordOf(boxes, {-1, 0.1F, 0.2F}, {1, 0, 0}, 50);
    EXPECT_NEAR(chord.swept, 2, 0.01) << wall;
    EXPECT_NEAR(chord.marched, 2, 0.01) << wall;
    EXPECT_NEAR(meshReference(boxes)->insideLength({{-1, 0.1F, 0.2F}, {1, 0, 0}}, INFINITY), 2, 1e-6) << wall;
  }
}

// Four triangles meet at the edge that two boxes share, and more at a corner: closed all the same, and chords through it add up.
TEST(HardShapes, BoxesThatTouchInAnEdgeOrACorner) {
  const SurfaceMesh first = boxMesh({0, 0, 0}, {1, 1, 1});
  for (const auto& [low, is_edge] : {std::pair{Vec3{1, 1, 0}, true}, {Vec3{1, 1, 1}, false}}) {
    const SurfaceMesh boxes = merged(first, boxMesh(low, low + Vec3{1, 1, 1}));
    EXPECT_EQ(findDefects(boxes).unmatched_edges, 0U);
    EXPECT_EQ(findDefects(boxes).non_manifold_edges.count, is_edge ? 1U : 0U);
    Warnings warnings;
    EXPECT_NEAR(fieldVolume(coverageFromClosedMesh(boxes, latticeOf(60), warnings).value()), 2, 0.02);
    EXPECT_NEAR(insideVolume(levelSetFromMesh(boxes, latticeOf(60), warnings)), 2, 0.03);
    const Vec3 along = *normalized(low);
    const Chord chord = chordOf(boxes, {0, 0, is_edge ? 0.5F : 0.0F}, along, 60);
    EXPECT_NEAR(chord.swept, 2 * length(low), 0.1) << is_edge;
    EXPECT_NEAR(chord.marched, 2 * length(low), 0.1) << is_edge;
    EXPECT_TRUE(warnings.empty());
  }
}

// A torus whose tube is thicker than its ring cuts itself and turns inside out about the axis: the lens there has winding 1 − 1 and is a
// cavity, whose chords are known.
TEST(HardShapes, ASelfIntersectingTorus) {
  const SurfaceMesh spindle = torusMesh(0.5F, 1, 192, 96);
  EXPECT_EQ(findDefects(spindle).unmatched_edges, 0U);
  const Chord through = chordOf(spindle, {0, -2, 0}, {0, 1, 0}, 100), across = chordOf(spindle, {-1.5F, 0, 0}, {1, 0, 0}, 100);
  for (const float length : {through.swept, through.marched}) EXPECT_NEAR(length, 0, 0.05);
  for (const float length : {across.swept, across.marched}) EXPECT_NEAR(length, 3 - 2 * 0.5, 0.02);
  Warnings warnings;
  const std::vector<Vec3> pole{{0, 0, 1.5F}}, normal{{0, 0, 1}};
  const BothBakes bakes = bakedBothWays(spindle, {pole, normal}, latticeOf(100));
  EXPECT_LT(angleDegrees(bakes.sweep[0].direction, {0, 0, -1}), 1.5);
  EXPECT_LT(angleDegrees(bakes.rays[0].direction, {0, 0, -1}), 1.5);
}

// A hundred thousand shells, each a third of a voxel, none of which the lattice holds: their mean does, and a ball of them is a thin ball.
TEST(HardShapes, AHundredThousandShells) {
  constexpr int kReach = 29;
  constexpr float kSide = 0.6F, kSpacing = 1;
  SurfaceMesh crumbs;
  size_t count = 0;
  for (int x = -kReach; x <= kReach; ++x)
    for (int y = -kReach; y <= kReach; ++y)
      for (int z = -kReach; z <= kReach; ++z) {
        if (x * x + y * y + z * z > kReach * kReach) continue;
        ++count;
        auto jitter = [&, n = uint64_t(0)]() mutable { return (uniformFloat(mix64(count * 3 + n++)) - 0.5F) * (kSpacing - kSide); };
        const Vec3 low{float(x) + jitter() - kSide / 2, float(y) + jitter() - kSide / 2, float(z) + jitter() - kSide / 2};
        crumbs = merged(std::move(crumbs), boxMesh(low, low + Vec3{kSide, kSide, kSide}));
      }
  EXPECT_GT(count, 100000U);
  const SurfaceMesh hull = ballMesh(kReach, 2);
  Warnings warnings;
  const CoverageField field = coverageFromClosedMesh(crumbs, voxelsOf(1.732F), warnings).value();
  const double share = std::pow(double(kSide), 3);
  EXPECT_NEAR(fieldVolume(field) / (double(count) * share), 1, 0.02);
  const auto reference = meshReference(crumbs);
  double swept = 0, exact = 0;
  for (size_t v = 0; v < hull.positions.size(); ++v) {
    auto next = [&, n = uint64_t(0)]() mutable { return 30 * uniformFloat(mix64(v * 3 + n++)) - 15; };
    const Vec3 from{next(), next(), next()}, along = hull.normals[v];
    swept += double(sweptLengths({&from, 1}, {&along, 1}, field, 1000)[0]);
    exact += reference->insideLength({from, along}, INFINITY);
  }
  EXPECT_NEAR(swept / exact, 1, 0.1);
  BakeSettings settings;
  settings.ray_length = boundingBox(crumbs).diagonal();
  settings.rays = 400;
  const std::vector<Lobe> lobes = bakeSweep({hull.positions, hull.normals}, field, settings, warnings);
  std::vector<Lobe> truth;
  for (const Vec3& n : hull.normals) truth.push_back({-n, 0});
  const AngleFigures angles = anglesBetween(lobes, truth);
  std::printf("[figures] %zu shells: median %.2f deg from the ball's, mean thickness %.3f of the exact one\n", count, angles.median,
              swept / exact);
  EXPECT_LT(angles.median, 4);
}
