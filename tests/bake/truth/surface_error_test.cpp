#include "bake/truth/surface_error.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "bake/mesh/surface.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

SurfaceMesh scaled(SurfaceMesh mesh, float factor, Vec3 offset) {
  for (Vec3& p : mesh.positions) p = p * factor + offset;
  return mesh;
}

}  // namespace

// A plate at height h over a larger one: every sample lies h away, the longest side is 4.
TEST(SurfaceError, PlateOverPlate) {
  const SurfaceMesh old{{{-2, 0, -2}, {2, 0, -2}, {2, 0, 2}, {-2, 0, 2}}, {}, {{0, 2, 1}, {0, 3, 2}}};
  for (const float scale : {1e-12F, 1.0F, 1e12F}) {
    const SurfaceMesh now = scaled(old, 0.5F, {0, 0.1F, 0});
    const SurfaceMesh at_scale = scaled(old, scale, {});
    const SurfaceError error = nearestSurface(at_scale)->errorOf(scaled(now, scale, {}));
    EXPECT_NEAR(error.rms, 0.025, 1e-8) << scale;
    EXPECT_NEAR(error.largest, 0.025, 1e-8) << scale;
  }
}

// Nearest to a corner, to an edge and to the inside of one triangle, and the centre of these three samples; the longest side is 1.
TEST(SurfaceError, CornersEdgesAndCentres) {
  const SurfaceMesh old{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}, {{0, 1, 2}}};
  const SurfaceMesh now{{{-0.3F, -0.4F, 0}, {0.5F, -0.2F, 0}, {0.25F, 0.25F, 0.1F}}, {}, {{0, 1, 2}}};
  const SurfaceError error = nearestSurface(old)->errorOf(now);
  const double center = std::hypot(0.35 / 3, 0.1 / 3);  // x inside, y = −0.35 / 3
  EXPECT_NEAR(error.largest, 0.5, 1e-7);
  EXPECT_NEAR(error.rms, std::sqrt((0.25 + 0.04 + 0.01 + center * center) / 4), 1e-7);
}

TEST(SurfaceError, TheSameSurfaceHasNone) {
  const SurfaceMesh ball = ballMesh(1, 4, {10, 20, 30});
  EXPECT_LT(nearestSurface(ball)->errorOf(ball).largest, 1e-6);
}

// A coarse ball against a fine one: its vertices lie on the sphere, its triangle centres up to a sagitta inside, here with R = 1/2.
TEST(SurfaceError, CoarseBallByItsSagitta) {
  const SurfaceMesh coarse = ballMesh(1, 2), fine = ballMesh(1, 6);
  double deepest = 0;
  for (const auto& [a, b, c] : coarse.triangles)
    deepest = std::max(deepest, 1 - double(length(coarse.positions[a] + coarse.positions[b] + coarse.positions[c])) / 3);
  EXPECT_NEAR(nearestSurface(fine)->errorOf(coarse).largest, deepest / 2, 2e-4);
}

// Collapses keep vertices where they lay: only centres lie off. The sums are the same for any number of threads.
TEST(SurfaceError, ReducedBallOnAnyThreads) {
  const SurfaceMesh ball = ballMesh(1, 5);
  SurfaceMesh reduced = ball;
  Warnings warnings;
  reduceVertices(reduced, 500, warnings);
  const SurfaceError error = nearestSurface(ball)->errorOf(reduced);
  EXPECT_GT(error.largest, 1e-3);
  EXPECT_LT(error.largest, 0.02);
  EXPECT_LT(error.rms, error.largest);
  for (const size_t threads : {1, 2, 7}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const SurfaceError other = nearestSurface(ball)->errorOf(reduced);
    EXPECT_EQ(other.rms, error.rms);
    EXPECT_EQ(other.largest, error.largest);
  }
}

// The place itself: at a corner, on an edge, inside.
TEST(SurfaceError, NearestPointsOfATriangle) {
  const SurfaceMesh triangle{{{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}, {{1, 2, 3}}};
  const std::vector<Vec3> above{{-0.3F, -0.4F, 0}, {0.25F, -0.2F, 0}, {0.25F, 0.5F, 0.1F}};
  const float expected[3][3] = {{1, 0, 0}, {0.75F, 0.25F, 0}, {0.25F, 0.25F, 0.5F}};
  const std::vector<SurfacePoint> points = nearestSurface(triangle)->nearestTo(above);
  ASSERT_EQ(points.size(), 3U);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(points[i].corners, (Triangle{1, 2, 3}));
    for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(points[i].weights[k], expected[i][k], 1e-5) << i << " " << k;
  }
}
