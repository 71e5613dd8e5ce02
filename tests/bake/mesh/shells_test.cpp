#include "bake/mesh/shells.h"

#include <gtest/gtest.h>

#include "bake/mesh/mesh_topology.h"
#include "tests/shapes.h"

using namespace cloudbake;

TEST(Shells, ArePiecesThatShareVertices) {
  const SurfaceMesh mesh = weldedByPosition(merged(merged(ballMesh(1, 2), boxMesh({3, 0, 0}, {4, 2, 3})), ballMesh(0.5F, 1, {0, 5, 0})));
  const std::vector<Shell> shells = shellsOf(mesh);
  ASSERT_EQ(shells.size(), 3U);
  EXPECT_EQ(shells[0].triangles.size(), ballMesh(1, 2).triangles.size());
  EXPECT_EQ(shells[1].triangles.size(), 12U);
  EXPECT_EQ(shells[1].triangles.front(), shells[0].triangles.size());
  EXPECT_NEAR(shells[1].volume, 6, 1e-5);
  EXPECT_EQ(shells[1].box.low, (Vec3{3, 0, 0}));
  SurfaceMesh inside_out = boxMesh({0, 0, 0}, {1, 2, 3});
  reverse(inside_out);
  EXPECT_NEAR(shellsOf(inside_out)[0].volume, -6, 1e-5);
}

// A closed surface: 1 inside, 0 outside, −1 inside of a reversed one. One face of a cube, seen from its middle: a sixth of the sphere.
TEST(Shells, WindingNumbersAreSolidAngles) {
  SurfaceMesh mesh = ballMesh(1, 3);
  EXPECT_NEAR(windingNumber(mesh, shellsOf(mesh)[0], {0.3F, -0.2F, 0.5F}), 1, 1e-6);
  EXPECT_NEAR(windingNumber(mesh, shellsOf(mesh)[0], {0.9F, 0.9F, 0.9F}), 0, 1e-6);
  reverse(mesh);
  EXPECT_NEAR(windingNumber(mesh, shellsOf(mesh)[0], {}), -1, 1e-6);
  SurfaceMesh box = boxMesh({-1, -1, -1}, {1, 1, 1});
  std::erase_if(box.triangles,
                [&](const Triangle& t) { return box.positions[t[0]].x + box.positions[t[1]].x + box.positions[t[2]].x < 3; });
  ASSERT_EQ(box.triangles.size(), 2U);
  EXPECT_NEAR(windingNumber(box, shellsOf(box)[0], {}), 1.0 / 6, 1e-6);
}

TEST(Shells, LieInsideOthersWhicheverWayTheyAreWound) {
  for (const bool reversed : {false, true}) {
    SurfaceMesh inner = ballMesh(0.5F, 2);
    if (reversed) reverse(inner);
    const SurfaceMesh mesh = weldedByPosition(merged(ballMesh(1, 3), inner));
    EXPECT_EQ(innerShells(mesh, shellsOf(mesh)), (std::vector<bool>{false, true}));
  }
  // In the box of a torus, but in its hole.
  const SurfaceMesh ring = weldedByPosition(merged(torusMesh(2, 0.5F, 24, 12), ballMesh(0.2F, 1)));
  EXPECT_EQ(innerShells(ring, shellsOf(ring)), (std::vector<bool>{false, false}));
}

// Balls on a lattice, each with a smaller one inside or beside it, inside and outside a large ball.
TEST(Shells, AreFoundInsideManyOthers) {
  SurfaceMesh mesh = ballMesh(3.2F, 4);
  std::vector<bool> expected{false};
  for (int i = 0; i < 9 * 9 * 9; ++i) {
    const Vec3 at{float(i % 9) - 4, float(i / 9 % 9) - 4, float(i / 81) - 4};
    if (length(at) > 2.4F && length(at) < 3.9F) continue;  // the small ones do not cross the large one
    const bool in_large = length(at) < 3.2F, beside = i % 3 == 0;
    mesh = merged(merged(mesh, ballMesh(0.3F, 1, at)), ballMesh(0.1F, 1, beside ? at + Vec3{0, 0.45F, 0} : at));
    expected.push_back(in_large);
    expected.push_back(in_large || !beside);
  }
  const SurfaceMesh welded = weldedByPosition(mesh);
  const std::vector<Shell> shells = shellsOf(welded);
  ASSERT_EQ(shells.size(), expected.size());
  std::vector<size_t> wrong;
  const std::vector<bool> inner = innerShells(welded, shells);
  for (size_t i = 0; i < shells.size(); ++i)
    if (inner[i] != expected[i]) wrong.push_back(i);
  EXPECT_EQ(wrong, std::vector<size_t>());
}

// A triangle alone encloses nothing, however many there are.
TEST(Shells, SingleTrianglesEncloseNothing) {
  SurfaceMesh soup;
  for (uint32_t i = 0; i < 3000; ++i) {
    const float size = 1 + float(i);
    soup.positions.insert(soup.positions.end(), {{-size, -size, -size}, {size, -size, size}, {0, size, 0.5F}});
    soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  EXPECT_EQ(innerShells(soup, shellsOf(soup)), std::vector<bool>(3000));
}
