#include "bake/truth/surface_error.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "bake/mesh/surface.h"
#include "core/surface_points.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

SurfaceMesh scaled(SurfaceMesh mesh, float factor, Vec3 offset) {
  for (Vec3& p : mesh.positions) p = p * factor + offset;
  return mesh;
}

// The square of the distance to a segment, and to a triangle: of the nearest place of its plane, if that is inside, or of an edge.
double squaredTo(const std::array<double, 3>& p, const std::array<double, 3>& a, const std::array<double, 3>& b) {
  double along = 0, length = 0, squared = 0;
  for (size_t i = 0; i < 3; ++i) along += (p[i] - a[i]) * (b[i] - a[i]), length += (b[i] - a[i]) * (b[i] - a[i]);
  const double share = length > 0 ? std::clamp(along / length, 0.0, 1.0) : 0;
  for (size_t i = 0; i < 3; ++i) squared += std::pow(a[i] + share * (b[i] - a[i]) - p[i], 2);
  return squared;
}
double squaredTo(Vec3 point, const SurfaceMesh& mesh, const Triangle& t) {
  const auto wide = [](Vec3 v) { return std::array<double, 3>{v.x, v.y, v.z}; };
  const auto p = wide(point), a = wide(mesh.positions[t[0]]), b = wide(mesh.positions[t[1]]), c = wide(mesh.positions[t[2]]);
  double least = std::min({squaredTo(p, a, b), squaredTo(p, b, c), squaredTo(p, c, a)});
  std::array<double, 3> n{};
  double square = 0, height = 0;
  for (size_t i = 0; i < 3; ++i) {
    const size_t j = (i + 1) % 3, k = (i + 2) % 3;
    n[i] = (b[j] - a[j]) * (c[k] - a[k]) - (b[k] - a[k]) * (c[j] - a[j]);
    square += n[i] * n[i], height += n[i] * (p[i] - a[i]);
  }
  const auto isInside = [&](const auto& from, const auto& to) {
    double side = 0;
    for (size_t i = 0; i < 3; ++i) {
      const size_t j = (i + 1) % 3, k = (i + 2) % 3;
      side += n[i] * ((to[j] - from[j]) * (p[k] - from[k]) - (to[k] - from[k]) * (p[j] - from[j]));
    }
    return side >= 0;
  };
  if (square > 0 && isInside(a, b) && isInside(b, c) && isInside(c, a)) least = std::min(least, height * height / square);
  return least;
}

// Beside all triangles one by one: long ones in any direction and short ones, points among them and far away.
TEST(SurfaceError, NearestOfAllTriangles) {
  SurfaceMesh mesh = ballMesh(0.7F, 3, {0.5F, 1.2F, 0});
  std::mt19937 random(5);
  std::uniform_real_distribution<float> share(-1, 1);
  const auto somewhere = [&] { return Vec3{share(random), share(random), share(random)}; };
  for (int i = 0; i < 300; ++i) {
    const Vec3 from = somewhere() * 3, to = from + somewhere() * 4;
    const auto first = uint32_t(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {from, to, (from + to) / 2 + somewhere() * 0.2F});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  const auto nearest = nearestSurface(mesh);
  for (const float size : {0.5F, 2.0F, 20.0F, 2000.0F}) {
    std::vector<Vec3> points(300);
    for (Vec3& p : points) p = somewhere() * size;
    const std::vector<SurfacePoint> found = nearest->nearestTo(points);
    for (size_t i = 0; i < points.size(); ++i) {
      double least = INFINITY;
      for (const Triangle& t : mesh.triangles) least = std::min(least, squaredTo(points[i], mesh, t));
      const double own = length(valueAt(found[i], mesh.positions) - points[i]);
      EXPECT_NEAR(own, std::sqrt(least), 2e-6 * std::max(1.0F, size)) << size;
    }
  }
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
