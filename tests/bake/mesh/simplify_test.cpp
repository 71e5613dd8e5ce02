#include "bake/mesh/simplify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "bake/mesh/mesh_topology.h"
#include "bake/truth/surface_error.h"
#include "core/parallel.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

std::set<uint32_t> used(const std::vector<Triangle>& triangles) {
  std::set<uint32_t> vertices;
  for (const Triangle& t : triangles) vertices.insert(t.begin(), t.end());
  return vertices;
}

std::vector<Triangle> simplifiedTo(const SurfaceMesh& mesh, size_t count, const std::vector<bool>& held = {}) {
  const std::vector<Vec3> light(mesh.positions.size());
  return simplified(mesh, light, held, std::array{count}).front();
}

// A square of n × n cells, bent along x; with a seam, the vertices on its middle column are there twice.
SurfaceMesh sheet(int n, bool has_seam) {
  SurfaceMesh mesh;
  std::map<std::pair<int, int>, uint32_t> left, right;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) {
      const auto add = [&] {
        const float u = float(x) / float(n);
        mesh.positions.push_back({u, 0.2F * std::sin(4 * u), float(y) / float(n)});
        return uint32_t(mesh.positions.size() - 1);
      };
      left[{x, y}] = right[{x, y}] = add();
      if (has_seam && 2 * x == n) right[{x, y}] = add();
    }
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      auto& at = 2 * x < n ? left : right;
      mesh.triangles.push_back({at[{x, y}], at[{x, y + 1}], at[{x + 1, y + 1}]});
      mesh.triangles.push_back({at[{x, y}], at[{x + 1, y + 1}], at[{x + 1, y}]});
    }
  return mesh;
}

// Directed edges of positions that only one triangle has.
std::set<std::pair<uint32_t, uint32_t>> openEdges(const SurfaceMesh& mesh) {
  std::set<std::pair<uint32_t, uint32_t>> edges, open;
  for (const Triangle& t : mesh.triangles)
    for (size_t k = 0; k < 3; ++k) edges.emplace(t[k], t[(k + 1) % 3]);
  for (const auto& [a, b] : edges)
    if (!edges.contains({b, a})) open.emplace(a, b);
  return open;
}

}  // namespace

TEST(Simplify, EveryLevelOfABallIsClosedAndHasItsSize) {
  const SurfaceMesh ball = ballMesh(1, 4, {3, 4, 5});
  const std::vector<Vec3> light(ball.positions.size());
  const auto levels = simplified(ball, light, {}, std::array<size_t, 3>{1281, 640, 256});
  ASSERT_EQ(levels.size(), 3U);
  const double distances[] = {0.002, 0.004, 0.01};
  const size_t sizes[] = {1281, 640, 256};
  for (size_t i = 0; i < 3; ++i) {
    const SurfaceMesh level{ball.positions, {}, levels[i]};
    EXPECT_EQ(used(level.triangles).size(), sizes[i]);
    EXPECT_EQ(findDefects(level).unmatched_edges, 0U);
    EXPECT_LT(nearestSurface(level)->errorOf(ball).rms, distances[i]);
    EXPECT_NEAR(signedVolume(level) / (4 * kPi / 3), 1, 0.03);
  }
  const std::set<uint32_t> first = used(levels[0]), last = used(levels[2]);
  EXPECT_TRUE(std::includes(first.begin(), first.end(), last.begin(), last.end()));
}

TEST(Simplify, ABorderStays) {
  const SurfaceMesh full = sheet(16, false);
  const SurfaceMesh level{full.positions, {}, simplifiedTo(full, 120)};
  EXPECT_LE(used(level.triangles).size(), 120U);
  EXPECT_EQ(openEdges(level), openEdges(full));
}

// Where a vertex at the seam is left, both of its sides are; nothing opens there.
TEST(Simplify, BothSidesOfASeamGoTogether) {
  const SurfaceMesh full = sheet(16, true);
  const SurfaceMesh level{full.positions, {}, simplifiedTo(full, 110)};
  const std::set<uint32_t> left = used(level.triangles);
  size_t both = 0, seam = 0;
  for (uint32_t v = 0; v + 1 < full.positions.size(); ++v) {
    if (!(full.positions[v] == full.positions[v + 1])) continue;
    ++seam;
    EXPECT_EQ(left.contains(v), left.contains(v + 1)) << v;
    both += left.contains(v);
  }
  EXPECT_EQ(seam, 17U);
  EXPECT_LT(both, 12U);  // straight, so that most of it can go
  EXPECT_GE(both, 2U);
  EXPECT_EQ(openEdges(weldedByPosition(level)).size(), openEdges(weldedByPosition(full)).size());
  for (const Triangle& t : level.triangles) {  // no triangle reaches over the seam
    float low = 1, high = 0;
    for (const uint32_t v : t) low = std::min(low, full.positions[v].x), high = std::max(high, full.positions[v].x);
    EXPECT_TRUE(high <= 0.5F || low >= 0.5F);
  }
}

TEST(Simplify, HeldVerticesStay) {
  const SurfaceMesh ball = ballMesh(1, 3);
  std::vector<bool> held(ball.positions.size());
  for (size_t v = 0; v < held.size(); ++v) held[v] = ball.positions[v].y > 0;
  const std::set<uint32_t> left = used(simplifiedTo(ball, 10, held));
  for (uint32_t v = 0; v < held.size(); ++v) EXPECT_TRUE(!held[v] || left.contains(v));
  EXPECT_LT(left.size(), ball.positions.size() * 2 / 3);
}

// Two flat halves: the one whose light changes keeps its vertices.
TEST(Simplify, LightHoldsVertices) {
  SurfaceMesh flat = sheet(20, false);
  for (Vec3& p : flat.positions) p.y = 0;
  std::vector<Vec3> light;
  for (const Vec3& p : flat.positions) light.push_back({p.x < 0.5F ? 0.05F * std::sin(30 * p.x) * std::sin(30 * p.z) : 0, 0, 0});
  size_t dark = 0, bright = 0;
  for (const uint32_t v : used(simplified(flat, light, {}, std::array<size_t, 1>{220}).front())) {
    const Vec3 p = flat.positions[v];
    if (p.x > 0 && p.x < 1 && p.z > 0 && p.z < 1) ++(p.x < 0.5F ? bright : dark);
  }
  EXPECT_GT(bright, 4 * dark);
}

// A fin on a ball gives an edge three triangles; the fin and its edge stay.
TEST(Simplify, ANonManifoldEdgeStays) {
  SurfaceMesh mesh = ballMesh(1, 3);
  const Triangle t = mesh.triangles.front();
  mesh.positions.push_back(mesh.positions[t[0]] * 1.5F);
  mesh.triangles.push_back({t[0], t[1], uint32_t(mesh.positions.size() - 1)});
  const std::vector<Triangle> level = simplifiedTo(mesh, 300);
  EXPECT_LE(used(level).size(), 300U);
  EXPECT_NE(std::find(level.begin(), level.end(), mesh.triangles.back()), level.end());
}

TEST(Simplify, WhatWouldRuinTheShapeStays) {
  const SurfaceMesh ball = ballMesh(1, 3);
  const std::vector<Triangle> level = simplifiedTo(ball, 4);
  EXPECT_GT(used(level).size(), 6U);
  const SurfaceMesh simplest{ball.positions, {}, level};
  EXPECT_LT(nearestSurface(simplest)->errorOf(ball).rms, 0.1);
}

TEST(Simplify, IsTheSameForAnyNumberOfThreads) {
  const SurfaceMesh ball = ballMesh(1, 4);
  const auto many = simplifiedTo(ball, 500);
  const ThreadLimit one(1);
  EXPECT_EQ(simplifiedTo(ball, 500), many);
}
