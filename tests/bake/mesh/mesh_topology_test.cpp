#include "bake/mesh/mesh_topology.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "tests/shapes.h"

using namespace cloudbake;

TEST(MeshTopology, ClosedShapesHaveNoDefects) {
  for (const SurfaceMesh& mesh : {ballMesh(1, 2), torusMesh(2, 0.5F, 24, 12), boxMesh({0, 0, 0}, {1, 1, 1})}) {
    const MeshDefects defects = findDefects(mesh);
    EXPECT_EQ(defects.unmatched_edges, 0U);
    EXPECT_EQ(defects.non_manifold_edges.count, 0U);
    EXPECT_EQ(defects.unreferenced_vertices.count, 0U);
  }
}

TEST(MeshTopology, CountsEachDefect) {
  SurfaceMesh mesh = boxMesh({0, 0, 0}, {1, 1, 1});
  mesh.triangles.pop_back();
  EXPECT_EQ(findDefects(mesh).unmatched_edges, 3U);  // one triangle less: three open edges
  mesh = boxMesh({0, 0, 0}, {1, 1, 1});
  std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
  EXPECT_EQ(findDefects(mesh).unmatched_edges, 6U);  // one triangle turned: each of its edges runs twice one way
  mesh.triangles.push_back({4, 4, 5});
  mesh.positions.push_back({9, 9, 9});
  EXPECT_EQ(findDefects(mesh).degenerate_triangles.count, 1U);
  EXPECT_EQ(findDefects(mesh).unreferenced_vertices.count, 1U);
}

// Each kind alone, with the place where it is met first.
TEST(MeshTopology, TellsWhereADefectIsFirst) {
  const SurfaceMesh box = boxMesh({0, 0, 0}, {1, 1, 1});
  SurfaceMesh mesh = box;
  mesh.triangles.erase(mesh.triangles.begin() + 5);
  MeshDefects defects = findDefects(mesh);
  EXPECT_EQ(defects.open_edges.count, 3U);
  EXPECT_EQ(defects.turned_edges.count + defects.non_manifold_edges.count + defects.duplicate_triangles.count, 0U);
  uint32_t lowest = 99;  // that shares two corners with the one that went
  for (uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    int shared = 0;
    for (const uint32_t a : mesh.triangles[f])
      for (const uint32_t b : box.triangles[5]) shared += a == b;
    if (shared == 2) lowest = std::min(lowest, f);
  }
  EXPECT_EQ(defects.open_edges.first, lowest);

  mesh = box;
  std::swap(mesh.triangles[7][0], mesh.triangles[7][1]);
  defects = findDefects(mesh);
  EXPECT_EQ(defects.turned_edges.count, 3U);
  EXPECT_EQ(defects.open_edges.count, 0U);

  mesh = box;  // a fin on an edge of triangle 3: that edge has three triangles, two others are open
  mesh.positions.push_back({5, 5, 5});
  mesh.triangles.push_back({mesh.triangles[3][0], mesh.triangles[3][1], 8});
  defects = findDefects(mesh);
  EXPECT_EQ(defects.non_manifold_edges.count, 1U);
  EXPECT_EQ(defects.open_edges.count, 2U);
  EXPECT_EQ(defects.open_edges.first, 12U);
  EXPECT_LE(defects.non_manifold_edges.first, 3U);

  mesh = box;
  mesh.positions.push_back({5, 5, 5});
  mesh.positions.push_back({6, 6, 6});
  EXPECT_EQ(findDefects(mesh).unreferenced_vertices.count, 2U);
  EXPECT_EQ(findDefects(mesh).unreferenced_vertices.first, 8U);
}

// A triangle and its double, turned or not, alone or in a mesh; three of one count two.
TEST(MeshTopology, CountsDoublesOnce) {
  const SurfaceMesh box = boxMesh({0, 0, 0}, {1, 1, 1});
  const Triangle t = box.triangles[4];
  for (const Triangle& twin : {Triangle{t[0], t[1], t[2]}, Triangle{t[1], t[2], t[0]}, Triangle{t[2], t[1], t[0]}}) {
    SurfaceMesh mesh = box;
    mesh.triangles.push_back(twin);
    EXPECT_EQ(findDefects(mesh).duplicate_triangles.count, 1U);
    EXPECT_EQ(findDefects(mesh).duplicate_triangles.first, 12U);
    mesh.triangles.push_back(twin);
    EXPECT_EQ(findDefects(mesh).duplicate_triangles.count, 2U);
  }
  const SurfaceMesh sheet{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}, {{0, 1, 2}, {0, 2, 1}}};
  EXPECT_EQ(findDefects(sheet).duplicate_triangles.count, 1U);
  EXPECT_EQ(findDefects(sheet).unmatched_edges, 0U);
}

TEST(MeshTopology, ATriangleOnALineHasNoArea) {
  SurfaceMesh mesh{{{0, 0, 0}, {1, 2, 3}, {3, 6, 9}, {3, 6, 9.0001F}}, {}, {{0, 1, 3}}};
  EXPECT_EQ(findDefects(mesh).degenerate_triangles.count, 0U);
  mesh.triangles = {{0, 1, 3}, {0, 1, 2}};
  EXPECT_EQ(findDefects(mesh).degenerate_triangles.count, 1U);
  EXPECT_EQ(findDefects(mesh).degenerate_triangles.first, 1U);
  for (Vec3& p : mesh.positions) p = p * 0x1p-40F;
  EXPECT_EQ(findDefects(mesh).degenerate_triangles.count, 1U);
}

// A box of split faces: at its corner the mean of three faces, whatever the file's own normals.
// Three triangles on one edge, one of them wound the other way, and a triangle that is only a side.
TEST(MeshTopology, EdgesComeInOrderWithAllTheirSides) {
  const std::vector<Triangle> triangles{{3, 0, 1}, {0, 1, 2}, {1, 0, 4}, {2, 5, 2}};
  using Ends = std::pair<uint32_t, uint32_t>;
  const auto edgesWith = [&](Degenerate degenerate) {
    std::vector<std::pair<Ends, size_t>> edges;
    forEachEdge(6, triangles, degenerate, [&](uint32_t low, std::span<EdgeSide> sides) {
      edges.push_back({{low, sides.front().high}, sides.size()});
      for (const EdgeSide& side : sides) {
        const uint32_t from = triangles[side.triangle][side.corner], to = triangles[side.triangle][(side.corner + 1) % 3];
        EXPECT_EQ(Ends(from, to), side.sense > 0 ? Ends(low, side.high) : Ends(side.high, low));
      }
    });
    return edges;
  };
  std::vector<std::pair<Ends, size_t>> expected{{{0, 1}, 3}, {{0, 2}, 1}, {{0, 3}, 1}, {{0, 4}, 1}, {{1, 2}, 1}, {{1, 3}, 1}, {{1, 4}, 1}};
  EXPECT_EQ(edgesWith(Degenerate::kLeftOut), expected);
  expected.push_back({{2, 5}, 2});
  EXPECT_EQ(edgesWith(Degenerate::kKept), expected);
}

// More vertices and triangles than one thread takes at a time.
TEST(MeshTopology, FindsFewDefectsAmongMany) {
  constexpr int kMajor = 400, kMinor = 250;
  const SurfaceMesh whole = torusMesh(2, 0.5F, kMajor, kMinor);
  SurfaceMesh mesh = whole;
  const size_t count = mesh.triangles.size();
  size_t edges = 0;
  std::pair<uint32_t, uint32_t> last{0, 0};
  forEachEdge(mesh.positions.size(), mesh.triangles, Degenerate::kLeftOut, [&](uint32_t low, std::span<EdgeSide> sides) {
    const std::pair<uint32_t, uint32_t> ends{low, sides.front().high};
    EXPECT_EQ(sides.size(), 2U);
    EXPECT_LT(last, ends);
    last = ends, ++edges;
  });
  EXPECT_EQ(edges, 3 * mesh.positions.size());

  const Triangle doubled = mesh.triangles[1000];
  mesh.triangles.push_back({doubled[1], doubled[2], doubled[0]});
  std::swap(mesh.triangles[count / 2][0], mesh.triangles[count / 2][1]);
  mesh.triangles[count - 7][0] = mesh.triangles[count - 7][1];
  mesh.positions.push_back({0, 9, 0});
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    const MeshDefects defects = findDefects(mesh);
    EXPECT_EQ(defects.duplicate_triangles.count, 1U);
    EXPECT_EQ(defects.duplicate_triangles.first, count);
    EXPECT_EQ(defects.turned_edges.count, 3U);
    EXPECT_EQ(defects.non_manifold_edges.count, 3U);
    EXPECT_EQ(defects.non_manifold_edges.first, 501U);  // a neighbour of triangle 1000
    EXPECT_EQ(defects.open_edges.count, 3U);
    EXPECT_EQ(defects.degenerate_triangles.count, 1U);
    EXPECT_EQ(defects.degenerate_triangles.first, count - 7);
    EXPECT_EQ(defects.unreferenced_vertices.count, 1U);
    EXPECT_EQ(defects.unreferenced_vertices.first, mesh.positions.size() - 1);
    EXPECT_EQ(defects.unmatched_edges, 3U + 3 * 2U + 3U);
  }

  // Every triangle with vertices of its own is the same mesh after welding.
  SurfaceMesh split;
  for (const Triangle& t : whole.triangles) {
    const auto first = uint32_t(split.positions.size());
    for (const uint32_t v : t) split.positions.push_back(whole.positions[v]);
    split.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_EQ(findDefects(split).unmatched_edges, 0U);
}

TEST(MeshTopology, SmoothNormalsLookThroughSeams) {
  const SurfaceMesh box = boxMesh({-1, -1, -1}, {1, 1, 1});
  SurfaceMesh split;
  for (const Triangle& t : box.triangles)
    for (const uint32_t v : t) split.positions.push_back(box.positions[v]);
  for (uint32_t i = 0; i < split.positions.size(); i += 3) split.triangles.push_back({i, i + 1, i + 2});
  const std::vector<Vec3> normals = smoothNormals(split);
  ASSERT_EQ(normals.size(), split.positions.size());
  for (size_t v = 0; v < normals.size(); ++v) EXPECT_LT(length(normals[v] - split.positions[v] * float(1 / std::sqrt(3.0))), 1e-5F);
}

TEST(MeshTopology, MeanEdgeOfACube) {
  EXPECT_NEAR(meanEdgeLength(boxMesh({0, 0, 0}, {2, 2, 2})), 2 * (2 + std::sqrt(2.0)) / 3, 1e-6);
  EXPECT_EQ(meanEdgeLength({}), 0);
}

// STL repeats every corner: open by index, closed by place. −0 and 0 are one place.
TEST(MeshTopology, WeldsByExactPosition) {
  const SurfaceMesh box = boxMesh({0, 0, 0}, {1, 1, 1});
  SurfaceMesh soup;
  for (const Triangle& t : box.triangles) {
    const auto n = uint32_t(soup.positions.size());
    for (const uint32_t v : t) soup.positions.push_back(box.positions[v]);
    soup.triangles.push_back({n, n + 1, n + 2});
  }
  soup.positions[0].x = -0.0F;
  EXPECT_EQ(weldedByPosition(soup).positions.size(), 8U);
  EXPECT_EQ(findDefects(soup).unmatched_edges, 0U);
}

// Box: a·b·c. Ball: 4π/3 R³ from below, as the icosphere is inscribed. Far from the origin nothing is lost.
TEST(MeshTopology, VolumeIsThatOfTheSolid) {
  EXPECT_NEAR(signedVolume(boxMesh({0, 0, 0}, {2, 3, 5})), 30, 1e-5);
  SurfaceMesh ball = ballMesh(2, 5);
  EXPECT_NEAR(signedVolume(ball), 4 * kPi / 3 * 8, 0.05);
  reverse(ball);
  EXPECT_LT(signedVolume(ball), 0);
  EXPECT_NEAR(signedVolume(boxMesh({4096, 4096, 4096}, {4098, 4099, 4101})), 30, 1e-4);
}
