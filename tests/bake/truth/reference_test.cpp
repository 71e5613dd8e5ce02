#include "bake/truth/reference.h"

#include <gtest/gtest.h>

#include "bake/lobe/directions.h"
#include "core/random.h"
#include "tests/shapes.h"

using namespace cloudbake;

// Two unit balls at x = 0 and x = 3 along +x from −2: chords 2 + 2, the gap of 1 not counted; overlapping at x = 1: union 3.
TEST(Reference, SphereUnionIsTheUnionOfIntervals) {
  const Sphere apart[] = {{{0, 0, 0}, 1}, {{3, 0, 0}, 1}}, overlapping[] = {{{0, 0, 0}, 1}, {{1, 0, 0}, 1}};
  const Ray ray{{-2, 0, 0}, {1, 0, 0}};
  EXPECT_NEAR(sphereReference(apart)->insideLength(ray, INFINITY), 4, 1e-12);
  EXPECT_NEAR(sphereReference(apart)->insideLength(ray, 2), 1, 1e-12);
  EXPECT_NEAR(sphereReference(overlapping)->insideLength(ray, INFINITY), 3, 1e-12);
  EXPECT_NEAR(sphereReference(apart)->insideLength({{0, 0, 0}, {0, 1, 0}}, INFINITY), 1, 1e-12);
}

// Box of sides 2, 4, 6 from the centre of a face: through an edge-crossing diagonal, straight, and outwards.
TEST(Reference, MeshChordsOfABoxByHand) {
  const SurfaceMesh box = boxMesh({-1, -2, -3}, {1, 2, 3});
  const auto reference = meshReference(box);
  EXPECT_NEAR(reference->insideLength({{-1, 0, 0}, {1, 0, 0}}, INFINITY), 2, 1e-6);  // face centre: on the diagonal of two triangles
  EXPECT_NEAR(reference->insideLength({{-1, 0, 0}, {-1, 0, 0}}, INFINITY), 0, 1e-6);
  EXPECT_NEAR(reference->insideLength({{-2, -4, -6}, *normalized(Vec3{1, 2, 3})}, INFINITY), 2 * std::sqrt(14.0),
              1e-5);  // corner to corner
  EXPECT_NEAR(reference->insideLength({{-3, 0, 0}, {1, 0, 0}}, 3), 1, 1e-6);
  EXPECT_NEAR(reference->insideLength({{0, 0, 0}, {0, 1, 0}}, INFINITY), 2, 1e-6);
}

// Rays of one origin go to Embree side by side, and the last packet is not full.
TEST(Reference, PacketsAgreeWithSingleRays) {
  const SurfaceMesh mesh = merged(ballMesh(1, 3), torusMesh(1, 0.4F, 64, 32));
  const auto reference = meshReference(mesh);
  const std::vector<Vec3> directions = fibonacciDirections(77),
                          positions{mesh.positions[0], mesh.positions[700], {0.1F, 0.2F, 0.3F}, {3, 0, 0}};
  for (const double length : {1.0, double(INFINITY)}) {
    const std::vector<float> lengths = trueLengths(*reference, positions, directions, length);
    for (size_t v = 0; v < positions.size(); ++v)
      for (size_t i = 0; i < directions.size(); ++i)
        EXPECT_EQ(lengths[v * directions.size() + i], float(reference->insideLength({positions[v], directions[i]}, length)))
            << v << " " << i;
  }
}

// Overlapping shells count once, a reversed inner shell is a cavity, a mesh turned inside out is the same solid.
TEST(Reference, InsideIsWindingNotZero) {
  const SurfaceMesh outer = boxMesh({-2, -2, -2}, {2, 2, 2});
  SurfaceMesh inner = boxMesh({-1, -1, -1}, {1, 1, 1});
  const Ray ray{{-5, 0.3F, 0.2F}, {1, 0, 0}};
  EXPECT_NEAR(meshReference(merged(outer, inner))->insideLength(ray, INFINITY), 4, 1e-6);
  reverse(inner);
  EXPECT_NEAR(meshReference(merged(outer, inner))->insideLength(ray, INFINITY), 2, 1e-6);
  EXPECT_NEAR(meshReference(inner)->insideLength(ray, INFINITY), 2, 1e-6);
}

// Two routes to one quantity: chords of balls by Embree on fine icospheres, and by intervals. The facets' sagitta is 1.2e-4.
TEST(Reference, EmbreeAgreesWithIntervalsOnTwoBalls) {
  const Sphere spheres[] = {{{0, 0, 0}, 1}, {{1.2F, 0.4F, 0}, 0.8F}};
  const SurfaceMesh mesh = merged(ballMesh(1, 6), ballMesh(0.8F, 6, {1.2F, 0.4F, 0}));
  const auto by_mesh = meshReference(mesh), by_intervals = sphereReference(spheres);
  const auto directions = fibonacciDirections(256);
  double worst = 0, sum = 0;
  int count = 0;
  for (size_t v = 0; v < mesh.positions.size(); v += 997)
    for (const Vec3& w : directions) {
      const double error =
          std::fabs(by_mesh->insideLength({mesh.positions[v], w}, INFINITY) - by_intervals->insideLength({mesh.positions[v], w}, INFINITY));
      worst = std::max(worst, error), sum += error, ++count;
    }
  EXPECT_GT(count, 20000);
  EXPECT_LT(sum / count, 3e-4);
  EXPECT_LT(worst, 0.05);  // a grazing chord: √(2 · 2R · sagitta)
}

// Quartic intersection of a line with a torus would be one route; slices are shorter: along x through the centre of a torus around y
// (R, r) the ray meets two discs, 4r in all; along y through the tube's middle, 2r; at height h, 2·2√(r² − h²).
TEST(Reference, TorusChordsInClosedForm) {
  const auto reference = meshReference(torusMesh(2, 0.5F, 512, 256));
  EXPECT_NEAR(reference->insideLength({{-5, 0, 0.001F}, {1, 0, 0}}, INFINITY), 2, 1e-3);
  EXPECT_NEAR(reference->insideLength({{2.001F, -3, 0.001F}, {0, 1, 0}}, INFINITY), 1, 1e-3);
  EXPECT_NEAR(reference->insideLength({{-5, 0.3F, 0.001F}, {1, 0, 0}}, INFINITY), 4 * std::sqrt(0.25 - 0.09), 2e-3);
}

// In the middle of a ball, with directions in opposite pairs, no direction is the mean one.
TEST(Reference, WithoutAMeanDirectionThereIsNoThickness) {
  const Sphere ball[] = {{{0, 0, 0}, 1}};
  const std::vector<Vec3> points{{0, 0, 0}}, directions{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  for (const auto& reference : {sphereReference(ball), meshReference(ballMesh(1, 3))}) {
    const Truth truth = trueLobes(*reference, points, directions, INFINITY);
    EXPECT_NEAR(truth.concentration[0], 0, 1e-6);
    if (truth.concentration[0] == 0) {
      EXPECT_EQ(truth.lobes[0].thickness, 0) << reference->name();
    }
  }
  EXPECT_EQ(trueLobes(*sphereReference(ball), points, directions, INFINITY).concentration[0], 0);
}

// Ball: o = inward normal by symmetry, d = 2R. Same at 1e-6 and 1e6 times the size.
TEST(Reference, TrueLobesOfABall) {
  for (const float scale : {1e-6F, 1.0F, 1e6F}) {
    const Sphere ball[] = {{{0, 0, 0}, scale}};
    const std::vector<Vec3> points{{0, scale, 0}, {0.6F * scale, 0, -0.8F * scale}};
    for (const auto& reference : {sphereReference(ball), meshReference(ballMesh(scale, 6))}) {
      const Truth truth = trueLobes(*reference, points, fibonacciDirections(4096), INFINITY);
      for (size_t v = 0; v < points.size(); ++v) {
        EXPECT_LT(angleDegrees(truth.lobes[v].direction, ballLobe(points[v], {}, scale).direction), 0.1) << reference->name() << scale;
        EXPECT_NEAR(truth.lobes[v].thickness / scale, 2, 1e-3);
        EXPECT_NEAR(truth.concentration[v], 0.75, 0.01);  // ∫cos³ / ∫cos² over the half sphere = 3/4
      }
    }
  }
}
