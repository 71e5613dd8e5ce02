#include "bake/repair.h"

#include <gtest/gtest.h>

#include "bake/mesh_topology.h"
#include "core/error.h"
#include "tests/shapes.h"

using namespace cloudbake;

#ifdef CLOUDBAKE_CGAL

// Half a ball without its disc: a hole of 2R. Finer balls would hollow it out to a shell of no volume; the wrap is solid, 2π/3 R³.
TEST(Repair, HalfBallBecomesSolid) {
  SurfaceMesh bowl = ballMesh(1, 4);
  std::erase_if(bowl.triangles,
                [&](const Triangle& t) { return bowl.positions[t[0]].y + bowl.positions[t[1]].y + bowl.positions[t[2]].y < 0; });
  const Wrap wrap = wrapClosed(bowl, 0.04);
  EXPECT_EQ(findDefects(wrap.mesh).unmatched_edges, 0U);
  EXPECT_NEAR(wrap.volume, 2 * kPi / 3, 0.35 * 2 * kPi / 3);
  EXPECT_GT(wrap.volume, 1.8);
}

// A ball with one triangle out: the finest wrap holds, and is within 2 % of 4π/3.
TEST(Repair, SmallHoleKeepsTheDetail) {
  SurfaceMesh ball = ballMesh(1, 4);
  ball.triangles.pop_back();
  const Wrap wrap = wrapClosed(ball, 0.1);
  EXPECT_LT(wrap.alpha, 0.25);
  EXPECT_NEAR(wrap.volume / (4 * kPi / 3), 1, 0.03);
}

// Triangle orientation is not believed: a soup with every other face turned gives the same solid at every size.
TEST(Repair, MixedOrientationAtEverySize) {
  for (const float scale : {1e-6F, 1.0F, 1e6F}) {
    SurfaceMesh ball = ballMesh(scale, 3, {3 * scale, 0, 0});
    for (size_t t = 0; t < ball.triangles.size(); t += 2) std::swap(ball.triangles[t][0], ball.triangles[t][1]);
    const Wrap wrap = wrapClosed(ball, 0.2 * scale);
    EXPECT_NEAR(wrap.volume / (4 * kPi / 3 * std::pow(scale, 3)), 1, 0.1) << scale;
  }
}

TEST(Repair, NothingCannotBeWrapped) {
  SurfaceMesh point;
  point.positions = {{1, 1, 1}};
  point.triangles = {{0, 0, 0}};
  EXPECT_THROW(wrapClosed(point, 1), InputError);
}

#else

TEST(Repair, RefusesByNameWithoutCgal) {
  EXPECT_FALSE(canWrap());
  EXPECT_THROW(wrapClosed(ballMesh(1, 1), 0.1), InputError);
}

#endif

// Triangles with three distinct corners on one line have no area, and nothing of them can be wrapped.
TEST(Repair, TrianglesWithoutAreaAreNothingToWrap) {
  if (!canWrap()) GTEST_SKIP();
  SurfaceMesh needles;
  for (int k = 0; k < 6; ++k) needles.positions.push_back({0, float(k), 0});
  needles.triangles = {{0, 1, 2}, {2, 3, 5}, {1, 4, 5}};
  EXPECT_THROW(wrapClosed(needles, 0.1), InputError);
}
