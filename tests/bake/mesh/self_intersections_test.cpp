#include "bake/mesh/self_intersections.h"

#include <gtest/gtest.h>

#include "tests/shapes.h"

using namespace cloudbake;

#ifdef CLOUDBAKE_CGAL

namespace {

uint64_t pairsOf(const SurfaceMesh& mesh) { return findSelfIntersections(mesh).count; }

}  // namespace

TEST(SelfIntersections, ClosedShapesHaveNone) {
  for (const SurfaceMesh& mesh : {ballMesh(1, 3), torusMesh(2, 0.5F, 24, 12), boxMesh({0, 0, 0}, {1, 1, 1})}) EXPECT_EQ(pairsOf(mesh), 0U);
  EXPECT_EQ(pairsOf(merged(ballMesh(1, 2), ballMesh(0.5F, 2))), 0U);  // one in the other cuts nothing
}

// A triangle in the plane z = 0, and what is laid beside and through it; each answer follows from the drawing.
TEST(SelfIntersections, EachWayOfMeeting) {
  const std::vector<Vec3> base{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  const auto with = [&](std::vector<Vec3> more, Triangle other) {
    SurfaceMesh mesh{base, {}, {{0, 1, 2}, other}};
    mesh.positions.insert(mesh.positions.end(), more.begin(), more.end());
    return pairsOf(mesh);
  };
  EXPECT_EQ(with({{1, 1, -1}, {1, 1, 1}, {1, -9, 0}}, {3, 4, 5}), 1U);  // pierces it
  EXPECT_EQ(with({{1, 1, 1}, {2, 1, 1}, {1, 2, 1}}, {3, 4, 5}), 0U);    // lies above it
  EXPECT_EQ(with({{1, 1, 0}, {2, 1, 3}, {1, 2, 3}}, {3, 4, 5}), 1U);    // touches it with a corner
  EXPECT_EQ(with({{-4, 0, 0}, {0, -4, 0}}, {0, 3, 4}), 0U);             // shares a corner, leads away
  EXPECT_EQ(with({{1, 1, -1}, {1, 1, 1}}, {0, 3, 4}), 1U);              // shares a corner, cuts it
  EXPECT_EQ(with({{4, 4, 0}}, {2, 1, 3}), 0U);                          // its neighbour in the plane
  EXPECT_EQ(with({{1, 1, 0}}, {2, 1, 3}), 1U);                          // folded back onto it
  EXPECT_EQ(with({{1, 1, 1e-6F}}, {2, 1, 3}), 0U);                      // nearly so
  EXPECT_EQ(with({}, {0, 2, 1}), 0U);                                   // its double, which findDefects counts
  EXPECT_EQ(with({{1, 1, 0}, {1, 1, 0}, {2, 2, 0}}, {3, 4, 5}), 0U);    // no area
}

// Two boxes through each other in a cross: the arms' sides cut through the bar's front and back.
TEST(SelfIntersections, TellTheLowestTriangle) {
  const SurfaceMesh bar = boxMesh({-3, -1, -1}, {3, 1, 1}), arm = boxMesh({-1, -3, -0.5F}, {1, 3, 0.5F});
  const Defect pairs = findSelfIntersections(merged(bar, arm));
  EXPECT_GT(pairs.count, 3U);
  EXPECT_LT(pairs.first, 12U);  // a triangle of the bar
  const Vec3 far{100, 0, 0};
  const Defect beside = findSelfIntersections(merged(merged(boxMesh(far, far + Vec3{1, 1, 1}), bar), arm));
  EXPECT_EQ(beside.count, pairs.count);
  EXPECT_EQ(beside.first, pairs.first + 12);
}

TEST(SelfIntersections, SplitVerticesAreOneVertex) {
  const SurfaceMesh ball = ballMesh(1, 2);
  SurfaceMesh soup;
  for (const Triangle& t : ball.triangles) {
    const auto n = uint32_t(soup.positions.size());
    for (const uint32_t v : t) soup.positions.push_back(ball.positions[v]);
    soup.triangles.push_back({n, n + 1, n + 2});
  }
  EXPECT_EQ(pairsOf(soup), 0U);
}

#else

TEST(SelfIntersections, RefusesByNameWithoutCgal) { EXPECT_ANY_THROW(findSelfIntersections(ballMesh(1, 1))); }

#endif
