// Splits of edges on meshes whose edges, areas and angles are known.
#include "bake/mesh/refine_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <set>
#include <tuple>

#include "bake/mesh/mesh_topology.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

EdgeTable edgesAt(const SurfaceMesh& mesh) {
  return edgesOf(mesh, [&](uint32_t a, uint32_t b) { return 0.5F * (mesh.positions[a] + mesh.positions[b]); });
}
// Splits the edges that `chosen` takes, and the longest edges that they need.
template <class Chosen>
std::vector<std::array<uint32_t, 2>> splitWhere(SurfaceMesh& mesh, const Chosen& chosen) {
  const EdgeTable table = edgesAt(mesh);
  std::vector<bool> marked;
  for (const SplittableEdge& edge : table.edges) marked.push_back(edge.can_split && chosen(edge));
  markLongest(table, marked);
  const size_t before = mesh.positions.size(), expected = verticesToAdd(mesh, table, marked);
  const auto parents = splitEdges(mesh, table, marked);
  EXPECT_EQ(mesh.positions.size(), before + expected);
  EXPECT_EQ(parents.size(), expected);
  return parents;
}
bool all(const SplittableEdge&) { return true; }

// Every corner of every triangle has vertices of its own, as at hard edges and seams.
SurfaceMesh apart(const SurfaceMesh& mesh) {
  SurfaceMesh result;
  for (const Triangle& t : mesh.triangles) {
    const auto first = uint32_t(result.positions.size());
    for (const uint32_t v : t) result.positions.push_back(mesh.positions[v]);
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

using Corners = std::array<std::tuple<float, float, float>, 3>;
// The triangles as positions, in an order that depends on nothing else.
std::vector<Corners> shapeOf(const SurfaceMesh& mesh) {
  std::vector<Corners> shape;
  for (const Triangle& t : mesh.triangles) {
    Corners corners;
    for (size_t i = 0; i < 3; ++i) corners[i] = {mesh.positions[t[i]].x, mesh.positions[t[i]].y, mesh.positions[t[i]].z};
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    shape.push_back(corners);
  }
  std::sort(shape.begin(), shape.end());
  return shape;
}

double leastAngle(const SurfaceMesh& mesh) {
  double least = 180;
  for (const Triangle& t : mesh.triangles)
    for (size_t i = 0; i < 3; ++i) {
      const Vec3 at = mesh.positions[t[i]], b = mesh.positions[t[(i + 1) % 3]], c = mesh.positions[t[(i + 2) % 3]];
      least = std::min(least, angleDegrees(*normalized(b - at), *normalized(c - at)));
    }
  return least;
}

TEST(RefineMesh, EdgesOfABox) {
  const SurfaceMesh box = boxMesh({0, 0, 0}, {1, 2, 3});
  const EdgeTable table = edgesAt(box);
  ASSERT_EQ(table.edges.size(), 18U);
  double area = 0;
  for (const SplittableEdge& edge : table.edges) {
    area += edge.area;
    EXPECT_TRUE(edge.can_split);
    EXPECT_EQ(edge.middle, 0.5F * (edge.ends[0] + edge.ends[1]));
    EXPECT_NEAR(edge.square_length, std::pow(double(length(edge.ends[1] - edge.ends[0])), 2), 1e-5);
  }
  EXPECT_NEAR(area, 3 * surfaceArea(box), 1e-5);
  EXPECT_EQ(edgesAt(apart(box)).edges.size(), 18U) << "seams are no edges of their own";
}

TEST(RefineMesh, KeepsAreaVolumeAndClosedness) {
  for (SurfaceMesh mesh : {boxMesh({-1, 0, 2}, {1, 2, 3}), ballMesh(1, 1, {0.1F, 0, 0}), apart(ballMesh(1, 1))}) {
    const double area = surfaceArea(mesh), volume = signedVolume(mesh);
    const auto triangles = mesh.triangles.size();
    splitWhere(mesh, all);
    EXPECT_EQ(mesh.triangles.size(), 4 * triangles);
    splitWhere(mesh, [](const SplittableEdge& edge) { return edge.middle.x > 0.3F; });
    EXPECT_NEAR(surfaceArea(mesh), area, 1e-5 * area);
    EXPECT_NEAR(signedVolume(mesh), volume, 1e-5 * std::fabs(volume));
    const MeshDefects defects = findDefects(mesh);
    EXPECT_EQ(defects.unmatched_edges, 0U);
    EXPECT_EQ(defects.open_edges.count + defects.non_manifold_edges.count + defects.degenerate_triangles.count, 0U);
  }
}

TEST(RefineMesh, OldVerticesStayAndNewOnesLieBetween) {
  SurfaceMesh mesh = boxMesh({0, 0, 0}, {1, 1, 1});
  mesh.normals = smoothNormals(mesh);
  const SurfaceMesh old = mesh;
  const auto parents = splitWhere(mesh, all);
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  EXPECT_TRUE(std::equal(old.positions.begin(), old.positions.end(), mesh.positions.begin()));
  for (size_t i = 0; i < parents.size(); ++i) {
    const auto [a, b] = parents[i];
    EXPECT_LT(a, b);
    EXPECT_EQ(mesh.positions[8 + i], 0.5F * (mesh.positions[a] + mesh.positions[b]));
    EXPECT_EQ(mesh.normals[8 + i], 0.5F * (mesh.normals[a] + mesh.normals[b])) << "as an engine blends them";
  }
}

TEST(RefineMesh, BorderStays) {
  SurfaceMesh square;
  square.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  for (int round = 0; round < 4; ++round) splitWhere(square, [](const SplittableEdge& edge) { return edge.middle.x < 0.4F; });
  EXPECT_GT(square.triangles.size(), 30U);
  EXPECT_NEAR(surfaceArea(square), 1, 1e-6);
  const EdgeTable table = edgesAt(square);
  std::vector<int> sides(table.edges.size(), 0);
  for (const auto& edges : table.of_triangle)
    for (const uint32_t edge : edges) ++sides[edge];
  for (size_t e = 0; e < sides.size(); ++e) {
    const Vec3 m = table.edges[e].middle;
    EXPECT_EQ(sides[e], m.x == 0 || m.x == 1 || m.y == 0 || m.y == 1 ? 1 : 2) << "only the old border is open";
  }
}

TEST(RefineMesh, AllFacesOfAnEdgeAreSplit) {
  SurfaceMesh fan;
  fan.positions = {{0, 0, 0}, {0, 0, 3}, {1, 0, 1}, {0, 1, 1}, {-1, -1, 1}};
  fan.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  const auto parents =
      splitWhere(fan, [](const SplittableEdge& edge) { return edge.ends[0].x == 0 && edge.ends[1].x == 0 && edge.middle.y == 0; });
  ASSERT_EQ(parents.size(), 1U);
  ASSERT_EQ(fan.triangles.size(), 6U);
  for (const Triangle& t : fan.triangles) EXPECT_EQ(std::count(t.begin(), t.end(), 5U), 1);
  SurfaceMesh loose = apart(fan);
  splitWhere(loose, all);
  splitWhere(fan, all);
  EXPECT_EQ(shapeOf(loose), shapeOf(fan));
}

TEST(RefineMesh, BothSidesOfAnEdgeThatMustNotBeSplitStay) {
  SurfaceMesh mesh = apart(boxMesh({0, 0, 0}, {1, 1, 1}));
  const auto fixed = [&](uint32_t v) { return v < 6; };  // the first two triangles, the side z = 0
  EdgeTable table = edgesOf(mesh, [&](uint32_t a, uint32_t b) -> std::optional<Vec3> {
    if (fixed(a)) return std::nullopt;
    return 0.5F * (mesh.positions[a] + mesh.positions[b]);
  });
  std::vector<bool> marked;
  for (const SplittableEdge& edge : table.edges) {
    EXPECT_EQ(edge.can_split, edge.ends[0].z != 0 || edge.ends[1].z != 0);
    marked.push_back(edge.can_split);
  }
  markLongest(table, marked);
  const auto first = mesh.triangles[0], second = mesh.triangles[1];
  splitEdges(mesh, table, marked);
  EXPECT_EQ(mesh.triangles[0], first);
  EXPECT_EQ(mesh.triangles[1], second);
  EXPECT_GT(mesh.triangles.size(), 20U);
  EXPECT_EQ(findDefects(mesh).unmatched_edges, 0U);

  // Middles that differ in their last bit would open the seam.
  mesh = apart(boxMesh({0, 0, 0}, {1, 1, 1}));
  table = edgesOf(mesh, [&](uint32_t a, uint32_t b) -> std::optional<Vec3> {
    Vec3 middle = 0.5F * (mesh.positions[a] + mesh.positions[b]);
    if (fixed(a)) middle.x = std::nextafter(middle.x, 2.0F);
    return middle;
  });
  for (const SplittableEdge& edge : table.edges) {
    const bool is_diagonal = edge.ends[0].x != edge.ends[1].x && edge.ends[0].y != edge.ends[1].y;
    EXPECT_EQ(edge.can_split, edge.ends[0].z != 0 || edge.ends[1].z != 0 || is_diagonal);
  }
}

TEST(RefineMesh, AnglesStaySane) {
  SurfaceMesh mesh = boxMesh({0, 0, 0}, {1, 1, 1});
  const double before = leastAngle(mesh);
  const auto atCorner = [](const SplittableEdge& edge) { return edge.ends[0] == Vec3{0, 0, 0}; };
  for (int round = 0; round < 12; ++round) splitWhere(mesh, atCorner);
  EXPECT_GE(leastAngle(mesh), before / 2 - 1e-3);
  EXPECT_EQ(findDefects(mesh).unmatched_edges, 0U);
}

TEST(RefineMesh, EdgesAreSplitUntilFloatsEnd) {
  SurfaceMesh mesh = boxMesh({1000, 1000, 1000}, {1000.0005F, 1000.0005F, 1000.0005F});
  for (int round = 0; round < 8; ++round) splitWhere(mesh, all);
  EXPECT_EQ(findDefects(mesh).unmatched_edges, 0U);
  for (const SplittableEdge& edge : edgesAt(mesh).edges) EXPECT_FALSE(edge.can_split);
}

TEST(RefineMesh, OrderOfVerticesAndTrianglesDoesNotMatter) {
  const SurfaceMesh ball = ballMesh(1, 1);
  SurfaceMesh shuffled;
  std::vector<uint32_t> order(ball.positions.size()), place(order.size());
  std::iota(order.begin(), order.end(), 0U);
  std::mt19937 random(5);
  std::shuffle(order.begin(), order.end(), random);
  for (uint32_t i = 0; i < order.size(); ++i) place[order[i]] = i;
  for (const uint32_t v : order) shuffled.positions.push_back(ball.positions[v]);
  for (const auto& [a, b, c] : ball.triangles) shuffled.triangles.push_back({place[b], place[c], place[a]});
  std::shuffle(shuffled.triangles.begin(), shuffled.triangles.end(), random);
  SurfaceMesh plain = ball;
  for (int round = 0; round < 3; ++round)
    for (SurfaceMesh* mesh : {&plain, &shuffled}) splitWhere(*mesh, [](const SplittableEdge& edge) { return edge.middle.y > 0.5F; });
  EXPECT_EQ(shapeOf(plain), shapeOf(shuffled));
}

TEST(RefineMesh, TrianglesWithEqualCornersDoNoHarm) {
  SurfaceMesh mesh = boxMesh({0, 0, 0}, {1, 1, 1});
  mesh.positions.push_back(mesh.positions[0]);
  mesh.triangles.push_back({0, 8, 1});
  mesh.triangles.push_back({2, 2, 3});
  splitWhere(mesh, all);
  for (const Triangle& t : mesh.triangles)
    for (const uint32_t v : t) EXPECT_LT(v, mesh.positions.size());
  EXPECT_EQ(findDefects(mesh).unmatched_edges, 0U);
}

}  // namespace
}  // namespace cloudbake
