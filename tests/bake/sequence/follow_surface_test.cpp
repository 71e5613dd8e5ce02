// A mesh that follows surfaces of which it is known where they go.
#include "bake/sequence/follow_surface.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "bake/mesh/mesh_topology.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

// A ball with bumps in three directions, moved and stretched.
SurfaceMesh bumpy(Vec3 place, float size, int subdivisions = 6) {
  SurfaceMesh mesh = ballMesh(1, subdivisions);
  for (Vec3& p : mesh.positions) p = p * (size * (1 + 0.2F * std::sin(5 * p.x) * std::sin(4 * p.y + 1) * std::sin(5 * p.z + 2))) + place;
  mesh.normals = smoothNormals(mesh);
  return mesh;
}

TEST(FollowingMesh, StaysOnAGrowingBall) {
  FollowingMesh mesh(ballMesh(1, 4));
  for (int i = 1; i <= 10; ++i) {
    const float radius = 1 + 0.1F * float(i);
    SurfaceMesh ball = ballMesh(radius, 6);
    ball.normals = smoothNormals(ball);
    const FollowFigures figures = mesh.follow(ball);
    EXPECT_FALSE(figures.isLost());
    EXPECT_EQ(figures.folded, 0);
    for (const Vec3& p : mesh.mesh().positions) EXPECT_NEAR(length(p), radius, 0.01F * radius) << i;
    EXPECT_NEAR(signedVolume(mesh.mesh()) / signedVolume(ball), 1, 1e-3) << "the volume is kept";
  }
  EXPECT_EQ(mesh.mesh().triangles, ballMesh(1, 4).triangles);
}

// A surface of another triangulation moves: its vertices go with it, not only along their normals.
TEST(FollowingMesh, GoesWithWhatMovesAsAWhole) {
  FollowingMesh mesh(bumpy({}, 1, 4));
  mesh.follow(bumpy({}, 1));
  const std::vector<Vec3> before = mesh.mesh().positions;
  const Vec3 way{0.06F, 0.02F, -0.03F};
  for (int i = 1; i <= 5; ++i) EXPECT_FALSE(mesh.follow(bumpy(way * float(i), 1)).isLost());
  double squares = 0;
  for (size_t v = 0; v < before.size(); ++v) {
    const Vec3 off = mesh.mesh().positions[v] - before[v] - way * 5.0F;
    squares += double(dot(off, off));
  }
  // Along normals alone, a ball's vertices would be off by √(2/3) of it.
  EXPECT_LT(std::sqrt(squares / double(before.size())), 0.4 * length(way) * 5) << "of the way";
}

TEST(FollowingMesh, RestsWithACloudThatRests) {
  FollowingMesh mesh(bumpy({}, 1, 4));
  for (int i = 0; i < 3; ++i) mesh.follow(bumpy({}, 1));
  const std::vector<Vec3> before = mesh.mesh().positions;
  for (int i = 0; i < 20; ++i) mesh.follow(bumpy({}, 1));
  for (size_t v = 0; v < before.size(); ++v) EXPECT_LT(length(mesh.mesh().positions[v] - before[v]), 0.015F) << v;
}

TEST(FollowingMesh, NoticesWhatItHasLost) {
  FollowingMesh mesh(ballMesh(1, 4));
  SurfaceMesh two = merged(ballMesh(1, 5), ballMesh(0.6F, 5, {2.5F, 0, 0}));
  two.normals = smoothNormals(two);
  const FollowFigures figures = mesh.follow(two);
  EXPECT_TRUE(figures.isLost());
  EXPECT_NEAR(figures.missed, 0.36 / 1.36, 0.02) << "the area of the small ball";
  FollowingMesh both(merged(ballMesh(1, 4), ballMesh(0.6F, 3, {2.5F, 0, 0})));
  SurfaceMesh one = ballMesh(1, 5);
  one.normals = smoothNormals(one);
  EXPECT_TRUE(both.follow(one).isLost()) << "a part has died";
}

TEST(FollowingMesh, DoesNotDependOnThreads) {
  const auto followed = [] {
    FollowingMesh mesh(bumpy({}, 1, 4));
    for (int i = 1; i <= 3; ++i) mesh.follow(bumpy({0.05F * float(i), 0, 0}, 1 + 0.05F * float(i)));
    return mesh.mesh().positions;
  };
  const std::vector<Vec3> all = followed();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(followed(), all);
}

TEST(OuterShells, LeavesOutCavitiesAndCrumbs) {
  SurfaceMesh cavity = ballMesh(0.5F, 3);
  reverse(cavity);
  const SurfaceMesh ball = ballMesh(1, 4), all = merged(merged(ball, cavity), ballMesh(0.05F, 2, {3, 0, 0}));
  const SurfaceMesh outer = outerShells(all);
  EXPECT_EQ(outer.positions.size(), ball.positions.size());
  EXPECT_EQ(outer.triangles.size(), ball.triangles.size());
  EXPECT_EQ(outer.normals.size(), outer.positions.size());
}

TEST(TopologyOf, CountsPartsAndHoles) {
  EXPECT_EQ(topologyOf(ballMesh(1, 3)), (SurfaceTopology{1, 0}));
  EXPECT_EQ(topologyOf(torusMesh(2, 0.5F, 24, 12)), (SurfaceTopology{1, 1}));
  SurfaceMesh far = torusMesh(2, 0.5F, 24, 12);
  for (Vec3& p : far.positions) p.x += 10;
  EXPECT_EQ(topologyOf(merged(merged(ballMesh(1, 3), far), ballMesh(1, 3, {20, 0, 0}))), (SurfaceTopology{3, 1}));
}

}  // namespace
}  // namespace cloudbake
