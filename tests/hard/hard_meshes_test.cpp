// What is wrong with sculpts and scans, through the whole pipeline. docs/numerics.md lists every hard case.
#include <gtest/gtest.h>

#include <cstring>

#include "bake/mesh/repair.h"
#include "io/gltf/asset/decode.h"
#include "io/gltf/asset/write.h"
#include "io/sculpt/read_mesh.h"
#include "tests/bake/both_bakes.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

// A ball whose surface waves: no symmetry, no sharp edge, chords with gaps.
SurfaceMesh lumpyBall() {
  SurfaceMesh mesh = ballMesh(1, 5);
  for (Vec3& p : mesh.positions) p = p * (1 + 0.15F * std::sin(4 * p.x + 1) + 0.12F * std::sin(5 * p.y) * std::cos(3 * p.z));
  mesh.normals = smoothNormals(mesh);
  return mesh;
}

// Every triangle with corners of its own.
SurfaceMesh splitAtEveryEdge(const SurfaceMesh& mesh) {
  SurfaceMesh split;
  for (const Triangle& t : mesh.triangles) {
    const auto first = uint32_t(split.positions.size());
    for (const uint32_t v : t) split.positions.push_back(mesh.positions[v]), split.normals.push_back(mesh.normals[v]);
    split.triangles.push_back({first, first + 1, first + 2});
  }
  return split;
}

}  // namespace

// Triangles without area have no normal and no sense: added to a mesh they change no bit of a swept lobe, and hardly the others.
TEST(HardMeshes, DegenerateTriangles) {
  const SurfaceMesh ball = ballMesh(1, 3);
  SurfaceMesh broken = ball;
  for (size_t f = 0; f < ball.triangles.size(); f += 5) {
    const auto [a, b, c] = ball.triangles[f];
    broken.triangles.push_back({a, a, b});
    broken.triangles.push_back({c, c, c});
  }
  EXPECT_EQ(findDefects(broken).degenerate_triangles.count, 2 * ((ball.triangles.size() + 4) / 5));
  EXPECT_EQ(findDefects(broken).unmatched_edges, 0U);
  const BothBakes plain = bakedBothWays(ball, 50), bakes = bakedBothWays(broken, 50);
  EXPECT_TRUE(sameBytes(plain.sweep, bakes.sweep));
  EXPECT_LT(anglesBetween(plain.rays, bakes.rays).largest, 0.05);
}

// Vertices that no triangle uses have no normal and lie where they like: those of the mesh keep their bits, the others get a finite lobe.
TEST(HardMeshes, UnreferencedVertices) {
  const SurfaceMesh ball = ballMesh(1, 3);
  SurfaceMesh mesh = ball;
  for (const Vec3 p : {Vec3{0.5F, 0, 0}, {0, 0.9F, 0.1F}}) mesh.positions.push_back(p), mesh.normals.emplace_back();
  EXPECT_EQ(findDefects(mesh).unreferenced_vertices.count, 2U);
  const BothBakes plain = bakedBothWays(ball, 50), bakes = bakedBothWays(mesh, 50);
  for (const auto& [few, all] : {std::pair{&plain.sweep, &bakes.sweep}, {&plain.rays, &bakes.rays}}) {
    EXPECT_EQ(std::memcmp(few->data(), all->data(), few->size() * sizeof(Lobe)), 0);
    const Lobe& inside = (*all)[ball.positions.size()];  // half way out: the bulk lies back through the centre
    EXPECT_LT(angleDegrees(inside.direction, {-1, 0, 0}), 2);
    EXPECT_NEAR(inside.thickness, 1.5, 0.03);
  }
}

// Inside out, every crossing has the other sign: taken as the same solid, told, and the same bits.
TEST(HardMeshes, InsideOut) {
  const SurfaceMesh ball = ballMesh(1, 4);
  SurfaceMesh inverted = ball;
  reverse(inverted);
  const BothBakes plain = bakedBothWays(ball, 50), bakes = bakedBothWays(inverted, {ball.positions, ball.normals}, latticeOf(50));
  EXPECT_TRUE(sameBytes(plain.sweep, bakes.sweep));
  EXPECT_LT(anglesBetween(plain.rays, bakes.rays).largest, 0.05);
  EXPECT_EQ(countOf(bakes.sweep_warnings, WarningKind::kInvertedMesh), 1U);
  EXPECT_EQ(countOf(bakes.rays_warnings, WarningKind::kInvertedMesh), 1U);
}

// Seams split a position into vertices with other UVs and normals: a lobe depends on the position alone, or seams would show.
TEST(HardMeshes, SplitsAtSeams) {
  const SurfaceMesh mesh = lumpyBall(), split = splitAtEveryEdge(mesh);
  EXPECT_EQ(findDefects(split).unmatched_edges, 0U);
  Warnings warnings;
  BakeSettings stratified;  // random per position
  stratified.ray_length = boundingBox(mesh).diagonal();
  const auto marched = [&](const SurfaceMesh& m) {
    return bakeSphereRays({m.positions, m.normals}, denseFromLevelSet(levelSetFromMesh(m, latticeOf(50), warnings)), stratified, warnings);
  };
  const std::vector<Lobe> rays = marched(mesh), rays_split = marched(split);
  const std::vector<Lobe> sweep = sweptLobes(mesh, {mesh.positions, mesh.normals}, latticeOf(50), warnings),
                          sweep_split = sweptLobes(split, {split.positions, split.normals}, latticeOf(50), warnings);
  for (size_t f = 0; f < mesh.triangles.size(); ++f)
    for (size_t k = 0; k < 3; ++k) {
      ASSERT_EQ(bitsOf(sweep[mesh.triangles[f][k]]), bitsOf(sweep_split[3 * f + k])) << f;
      ASSERT_EQ(bitsOf(rays[mesh.triangles[f][k]]), bitsOf(rays_split[3 * f + k])) << f;
    }
}

// A mirrored node turns triangles round and stores lobes in a left-handed space: read back in the scene, a ball is a ball.
TEST(HardMeshes, AMirroredNode) {
  const SurfaceMesh ball = ballMesh(1, 4);
  const Affine mirror{{{{-2, 0, 0}, {0, 2, 0}, {0, 0, 2}}}, {7, -3, 1}};
  const Sculpt sculpt{{SculptPart{"mirrored", ball.positions, ball.normals, {}, ball.triangles, mirror}}, nullptr};
  const SurfaceMesh scene = surfaceInScene(sculpt);
  EXPECT_GT(signedVolume(scene), 0);
  const BothBakes bakes = bakedBothWays(scene, 60);
  Warnings warnings;
  for (const auto* lobes : {&bakes.sweep, &bakes.rays}) {
    const BakedMesh back = decodeGlb("a.glb", encodeGlb(sculpt, std::vector<std::vector<Lobe>>{*lobes}, {}, {}, warnings), warnings);
    std::vector<Lobe> truth;
    for (const Vec3& p : back.surface.positions) truth.push_back(ballLobe(p, {7, -3, 1}, 2));
    EXPECT_LT(anglesBetween(back.lobes, truth).median, 1);
    EXPECT_LT(anglesBetween(back.lobes, *lobes).largest, 1e-3);
    for (const Lobe& lobe : back.lobes) ASSERT_NEAR(lobe.thickness / 4, 1, 0.04);
  }
}

// An open scan has no inside: a flood turns it into crumbs and calls that a success. It is told by the volume, and a wrap cures it.
TEST(HardMeshes, AnOpenScanThatFallsToCrumbs) {
  if (!hasCgal()) GTEST_SKIP();
  SurfaceMesh scan = ballMesh(1, 5);
  std::erase_if(scan.triangles, [&](const Triangle& t) { return scan.positions[t[0]].y > 0.6F; });
  Warnings warnings;
  EXPECT_FALSE(coverageFromClosedMesh(scan, {}, warnings).has_value());
  const std::string refusal = refusalOf([&] { levelSetFromOpenMesh(scan, {}, warnings); });
  EXPECT_NE(refusal.find("the mesh is open, and its level set contains only"), std::string::npos) << refusal;
  const double cap = kPi * 0.4 * 0.4 * (3 - 0.4) / 3, truth = 4 * kPi / 3 - cap;
  EXPECT_NEAR(wrapClosed(scan, 0.08).volume / truth, 1, 0.2);
  uint64_t holes = 0;
  EXPECT_NEAR(signedVolume(closedByFilling(scan, holes).value()) / truth, 1, 0.02);
  EXPECT_EQ(holes, 1U);
}

// A triangle that is there twice makes edges of three, at which a winding is no longer defined: the second one counts for nothing.
TEST(HardMeshes, DuplicateTriangles) {
  if (!hasCgal()) GTEST_SKIP();
  const SurfaceMesh ball = ballMesh(1, 4);
  SurfaceMesh broken = ball;
  for (size_t f = 0; f < ball.triangles.size(); f += 3) {
    const auto [a, b, c] = ball.triangles[f];
    broken.triangles.push_back(f % 2 ? Triangle{a, b, c} : Triangle{b, a, c});
  }
  EXPECT_GT(findDefects(broken).unmatched_edges, 0U);
  uint64_t holes = 0;
  const auto closed = closedByFilling(broken, holes);
  ASSERT_TRUE(closed);
  EXPECT_EQ(holes, 0U);
  Warnings warnings;
  EXPECT_TRUE(sameBytes(sweptLobes(ball, {ball.positions, ball.normals}, latticeOf(60), warnings),
                        sweptLobes(*closed, {ball.positions, ball.normals}, latticeOf(60), warnings)));
}

// All that real scans have at once, on a shape whose unbroken twin is known: holes of four sizes, a third of the triangles turned, doubles,
// triangles without area and vertices that nothing uses. Filled and oriented, it bakes as its twin does.
TEST(HardMeshes, ABrokenScanEqualsItsTwin) {
  if (!hasCgal()) GTEST_SKIP();
  const SurfaceMesh twin = lumpyBall();
  SurfaceMesh scan = twin;
  const std::pair<Vec3, float> holes_of_scan[] = {{{1, 0.2F, 0.1F}, 0.93F},
                                                  {{-0.3F, 1, 0.4F}, 0.99F},
                                                  {{0.1F, -1, 0.5F}, 0.997F},
                                                  {{-1, -0.4F, -0.7F}, 0.9995F},
                                                  {{0.2F, 0.3F, -1}, 0.997F}};
  for (const auto& [towards, cosine] : holes_of_scan)
    std::erase_if(scan.triangles,
                  [&, at = *normalized(towards), c = cosine](const Triangle& t) { return dot(*normalized(scan.positions[t[0]]), at) > c; });
  const size_t left = scan.triangles.size();
  for (size_t f = 0; f < left; f += 3) std::swap(scan.triangles[f][1], scan.triangles[f][2]);
  for (size_t f = 0; f < left; f += 50) scan.triangles.push_back(scan.triangles[f]);
  for (size_t f = 0; f < left; f += 70) scan.triangles.push_back({scan.triangles[f][0], scan.triangles[f][1], scan.triangles[f][1]});
  const MeshDefects defects = findDefects(scan);
  EXPECT_GT(defects.open_edges.count, 50U);
  EXPECT_GT(defects.turned_edges.count, 1000U);
  EXPECT_GT(defects.duplicate_triangles.count, 100U);
  EXPECT_GT(defects.degenerate_triangles.count, 100U);
  EXPECT_GT(defects.unreferenced_vertices.count, 100U);
  uint64_t filled = 0;
  const auto solid = closedByFilling(scan, filled);
  ASSERT_TRUE(solid);
  EXPECT_GE(filled, std::size(holes_of_scan));
  Warnings warnings;
  const std::vector<Lobe> expected = sweptLobes(twin, {twin.positions, twin.normals}, {}, warnings);
  const std::vector<Lobe> repaired = sweptLobes(*solid, {twin.positions, twin.normals}, {}, warnings);
  const AngleFigures angles = anglesBetween(repaired, expected);
  std::printf("[figures] broken scan against its twin: median %.3f deg, p95 %.3f deg, largest %.3f deg; volume %.4f of the twin's\n",
              angles.median, angles.p95, angles.largest, signedVolume(*solid) / signedVolume(twin));
  EXPECT_LE(angles.median, 2);
  EXPECT_LE(angles.p95, 5);
}
