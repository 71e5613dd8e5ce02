#include "bake/mesh/surface.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "bake/field/level_set.h"
#include "bake/mesh/mesh_topology.h"
#include "core/random.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

SurfaceMesh surfaceOf(std::vector<Sphere> spheres, SurfaceSettings settings = {}, float blend = 0, int voxels = 100) {
  Warnings warnings;
  LevelSetSettings level_set;
  level_set.blend = blend;
  level_set.voxels = voxels;
  return meshFromLevelSet(levelSetFromSpheres(spheres, level_set, warnings), settings, warnings);
}

const std::vector<Sphere> kCluster{{{0, 0, 0}, 1}, {{0.9F, 0.3F, 0}, 0.7F}, {{-0.7F, 0.4F, 0.5F}, 0.6F}, {{0.1F, 0.9F, -0.2F}, 0.5F}};

}  // namespace

// Closed, outward, on the sphere to a fiftieth of a voxel.
TEST(Surface, BallIsOnTheBall) {
  const SurfaceMesh ball = surfaceOf({{{5, 6, 7}, 1}});
  EXPECT_EQ(findDefects(ball).unmatched_edges, 0U);
  EXPECT_NEAR(signedVolume(ball), 4 * kPi / 3, 0.005);
  double worst = 0, tilt = 0;
  for (size_t v = 0; v < ball.positions.size(); ++v) {
    const Vec3 n = ball.positions[v] - Vec3{5, 6, 7};
    worst = std::max(worst, std::fabs(double(length(n)) - 1));
    tilt = std::max(tilt, angleDegrees(ball.normals[v], *normalized(n)));
  }
  EXPECT_LT(worst, 0.02 * 0.02);
  EXPECT_LT(tilt, 3);
}

// A budget is kept, the mesh stays closed and outward, its volume within 1 %.
TEST(Surface, BudgetKeepsTheShape) {
  const SurfaceMesh full = surfaceOf(kCluster, {}, 0.1F), reduced = surfaceOf(kCluster, {.vertices = 3000}, 0.1F);
  EXPECT_GT(full.positions.size(), 10000U);
  EXPECT_LE(reduced.positions.size(), 3000U);
  EXPECT_GT(reduced.positions.size(), 2900U);
  EXPECT_EQ(findDefects(reduced).unmatched_edges, 0U);
  EXPECT_NEAR(signedVolume(reduced) / signedVolume(full), 1, 0.01);
  EXPECT_EQ(reduced.normals.size(), reduced.positions.size());
}

TEST(Surface, EveryRandomClusterIsClosed) {
  for (int n = 0; n < 10; ++n) {
    std::vector<Sphere> spheres = kCluster;
    for (Sphere& s : spheres) s.center = s.center * (0.8F + 0.05F * float(n));
    const SurfaceMesh mesh = surfaceOf(spheres, {.vertices = 1000}, 0, 40);
    EXPECT_EQ(findDefects(mesh).unmatched_edges, 0U) << n;
    EXPECT_GT(signedVolume(mesh), 0) << n;
  }
}

// Collapses that do not look at the topology would pinch some of these surfaces: four triangles would share an edge.
TEST(Surface, NoBudgetPinches) {
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    std::vector<Sphere> spheres;
    for (uint64_t k = 0; k < 60; ++k) {
      const auto draw = [&](uint64_t part) { return float(uniformDouble(mix64(seed * 1000 + k * 4 + part))); };
      spheres.push_back({{2.4F * draw(0), 1.6F * draw(1), 2 * draw(2)}, 0.2F + 0.35F * draw(3)});
    }
    const SurfaceMesh mesh = surfaceOf(spheres, {.vertices = 1200}, 0, 100);
    EXPECT_EQ(findDefects(mesh).non_manifold_edges.count, 0U) << seed;
    EXPECT_EQ(findDefects(mesh).unmatched_edges, 0U) << seed;
    EXPECT_LE(mesh.positions.size(), 1200U) << seed;
  }
}

// A third face on an edge stays where it is, and so do its three vertices, while the rest is thinned out.
TEST(Surface, NonManifoldFacesAreKept) {
  SurfaceMesh mesh = ballMesh(1, 4);
  const Vec3 a = mesh.positions[mesh.triangles[0][0]], b = mesh.positions[mesh.triangles[0][1]], c{0, 3, 0};
  mesh.positions.push_back(c);
  mesh.triangles.push_back({mesh.triangles[0][0], mesh.triangles[0][1], uint32_t(mesh.positions.size() - 1)});
  Warnings warnings;
  const size_t target = mesh.positions.size() / 2;
  reduceVertices(mesh, target, warnings);
  EXPECT_EQ(mesh.positions.size(), target);
  EXPECT_TRUE(warnings.empty());
  EXPECT_EQ(findDefects(mesh).non_manifold_edges.count, 1U);
  const auto holds = [&](const Triangle& t, Vec3 p) {
    return std::any_of(t.begin(), t.end(), [&](uint32_t v) { return mesh.positions[v] == p; });
  };
  EXPECT_EQ(std::count_if(mesh.triangles.begin(), mesh.triangles.end(),
                          [&](const Triangle& t) { return holds(t, a) && holds(t, b) && holds(t, c); }),
            1);
}

// An open border is not moved; a budget below it is missed, and said so. Vertices that no triangle uses go first.
TEST(Surface, BordersStayAndAMissedBudgetIsCounted) {
  SurfaceMesh half = ballMesh(1, 4);
  std::erase_if(half.triangles, [&](const Triangle& t) {
    return std::any_of(t.begin(), t.end(), [&](uint32_t v) { return half.positions[v].y < -0.3F; });
  });
  const size_t border = findDefects(half).unmatched_edges;
  ASSERT_GT(border, 20U);
  Warnings warnings;
  SurfaceMesh reduced = half;
  reduceVertices(reduced, border + 30, warnings);
  EXPECT_EQ(reduced.positions.size(), border + 30);
  EXPECT_EQ(findDefects(reduced).unmatched_edges, border);
  EXPECT_TRUE(warnings.empty());
  reduceVertices(reduced, border / 2, warnings);
  EXPECT_EQ(findDefects(reduced).unmatched_edges, border);
  const auto missed = warnings.entries().at(WarningKind::kVertexBudget);
  EXPECT_EQ(missed.count, 1U);
  EXPECT_NE(missed.first.find(std::to_string(border) + " lie on borders"), std::string::npos) << missed.first;
}
