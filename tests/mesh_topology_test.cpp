#include "bake/mesh_topology.h"

#include <gtest/gtest.h>

#include "tests/shapes.h"

using namespace cloudbake;

TEST(MeshTopology, ClosedShapesHaveNoDefects) {
  for (const SurfaceMesh& mesh : {ballMesh(1, 2), torusMesh(2, 0.5F, 24, 12), boxMesh({0, 0, 0}, {1, 1, 1})}) {
    const MeshDefects defects = findDefects(mesh);
    EXPECT_EQ(defects.unmatched_edges, 0U);
    EXPECT_EQ(defects.non_manifold_edges, 0U);
    EXPECT_EQ(defects.unreferenced_vertices, 0U);
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
  EXPECT_EQ(findDefects(mesh).degenerate_triangles, 1U);
  EXPECT_EQ(findDefects(mesh).unreferenced_vertices, 1U);
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
