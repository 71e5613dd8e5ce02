#include "core/vertex_normals.h"

#include <gtest/gtest.h>

#include <array>

#include "tests/shapes.h"

using namespace cloudbake;

// The corner of a cube: three faces at equal angles whatever their diagonals, so the normal is the space diagonal.
TEST(VertexNormals, DoNotDependOnTheTessellation) {
  const SurfaceMesh box = boxMesh({-1, -1, -1}, {1, 1, 1});
  const std::vector<Vec3> normals = vertexNormals(box.positions, box.triangles);
  for (size_t v = 0; v < box.positions.size(); ++v) EXPECT_LT(angleDegrees(normals[v], *normalized(box.positions[v])), 1e-3);
}

// The angles are polynomials: within rounding of the library's in double.
TEST(VertexNormals, AreWeightedByTheAngles) {
  const SurfaceMesh ball = ballMesh(1, 2);
  SurfaceMesh mesh = ball;
  for (size_t v = 0; v < mesh.positions.size(); ++v) mesh.positions[v] = mesh.positions[v] * (0.3F + float(v * 7919 % 100) / 50);
  const std::vector<Vec3> normals = vertexNormals(mesh.positions, mesh.triangles);
  std::vector<std::array<double, 3>> sums(normals.size());
  for (const Triangle& t : mesh.triangles)
    for (size_t i = 0; i < 3; ++i) {
      const Vec3 p = mesh.positions[t[i]], a = mesh.positions[t[(i + 1) % 3]] - p, b = mesh.positions[t[(i + 2) % 3]] - p;
      const Vec3 normal = *normalized(cross(a, b));
      const double angle = angleDegrees(*normalized(a), *normalized(b));
      sums[t[i]][0] += normal.x * angle, sums[t[i]][1] += normal.y * angle, sums[t[i]][2] += normal.z * angle;
    }
  for (size_t v = 0; v < normals.size(); ++v)
    EXPECT_LT(angleDegrees(normals[v], *normalized(Vec3{float(sums[v][0]), float(sums[v][1]), float(sums[v][2])})), 1e-4) << v;
}

TEST(VertexNormals, OfABallPointOutwardsAtEverySize) {
  for (const float radius : {1e-6F, 1.0F, 1e6F}) {
    const SurfaceMesh ball = ballMesh(radius, 4);
    const std::vector<Vec3> normals = vertexNormals(ball.positions, ball.triangles);
    for (size_t v = 0; v < ball.positions.size(); ++v) EXPECT_LT(angleDegrees(normals[v], ball.normals[v]), 1) << radius;
  }
}

TEST(VertexNormals, UnusedAndDegenerateVerticesHaveNone) {
  SurfaceMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {9, 9, 9}};
  mesh.triangles = {{0, 1, 2}, {0, 0, 1}};
  for (const Vec3& normal : vertexNormals(mesh.positions, mesh.triangles)) EXPECT_EQ(normal, (Vec3{}));
}

// Three triangles lie in one plane, and the third is folded back over the first two: at the tip the angles cancel, the areas do not.
TEST(VertexNormals, TheTipOfAFlatFoldHasThatOfThePlane) {
  for (const float size : {1e-3F, 1.0F, 1e3F}) {
    SurfaceMesh mesh;
    mesh.positions = {{0, 0, 0}, {0, 0, -2 * size}, {2 * size, 0, -size}, {-0.5F * size, 0, -0.75F * size}};
    mesh.triangles = {{0, 2, 3}, {3, 2, 1}, {0, 3, 1}};
    const Vec3 normal = vertexNormals(mesh.positions, mesh.triangles)[3];
    EXPECT_NEAR(normal.y, 1, 1e-6) << size;
  }
  SurfaceMesh sheet;
  sheet.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 1}};
  for (const Vec3& normal : vertexNormals(sheet.positions, sheet.triangles)) EXPECT_EQ(normal, (Vec3{}));
}
