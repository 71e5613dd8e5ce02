#include "bake/mesh/repair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>

#include "bake/mesh/mesh_topology.h"
#include "core/error.h"
#include "tests/shapes.h"

using namespace cloudbake;

#ifdef CLOUDBAKE_CGAL

namespace {

std::vector<double> edgeLengths(const SurfaceMesh& mesh) {
  std::vector<double> lengths;
  for (const Triangle& t : mesh.triangles)
    for (size_t k = 0; k < 3; ++k) lengths.push_back(length(mesh.positions[t[k]] - mesh.positions[t[(k + 1) % 3]]));
  std::sort(lengths.begin(), lengths.end());
  return lengths;
}

// A cone of height 1 over n points of a unit circle, without its base.
SurfaceMesh openCone(int n) {
  SurfaceMesh cone;
  cone.positions.push_back({0, 1, 0});
  for (int i = 0; i < n; ++i) cone.positions.push_back({float(std::cos(2 * kPi * i / n)), 0, float(std::sin(2 * kPi * i / n))});
  for (int i = 0; i < n; ++i) cone.triangles.push_back({0, uint32_t(1 + (i + 1) % n), uint32_t(1 + i)});
  return cone;
}

SurfaceMesh bowlMesh() {
  SurfaceMesh bowl = ballMesh(1, 4);
  std::erase_if(bowl.triangles,
                [&](const Triangle& t) { return bowl.positions[t[0]].y + bowl.positions[t[1]].y + bowl.positions[t[2]].y < 0; });
  return bowl;
}

// Edges a→b that no edge b→a meets, as pairs of places.
std::set<std::array<float, 6>> borderOf(const SurfaceMesh& mesh) {
  std::set<std::array<float, 6>> border;
  const auto edge = [&](uint32_t a, uint32_t b) {
    const Vec3 p = mesh.positions[a], q = mesh.positions[b];
    return std::array{p.x, p.y, p.z, q.x, q.y, q.z};
  };
  for (const Triangle& t : mesh.triangles)
    for (size_t k = 0; k < 3; ++k)
      if (const auto met = border.find(edge(t[(k + 1) % 3], t[k])); met != border.end())
        border.erase(met);
      else
        border.insert(edge(t[k], t[(k + 1) % 3]));
  return border;
}

// Vertices, triangles and their order stay; only windings may differ.
void expectSameTriangles(const SurfaceMesh& mesh, const SurfaceMesh& source) {
  ASSERT_GE(mesh.triangles.size(), source.triangles.size());
  EXPECT_EQ(mesh.positions, source.positions);
  for (size_t f = 0; f < source.triangles.size(); ++f) {
    Triangle a = mesh.triangles[f], b = source.triangles[f];
    std::sort(a.begin(), a.end()), std::sort(b.begin(), b.end());
    EXPECT_EQ(a, b);
  }
}

RepairSummary repaired(SurfaceMesh& mesh, const RepairSettings& settings, const std::vector<uint32_t>& parts = {},
                       Warnings* warnings = nullptr) {
  std::vector<bool> turned;
  Warnings own;
  return repairMesh(mesh, parts, settings, turned, warnings ? *warnings : own);
}

SurfaceMesh withHoleAbove(SurfaceMesh mesh, float height) {
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return std::max({mesh.positions[t[0]].y, mesh.positions[t[1]].y, mesh.positions[t[2]].y}) > height;
  });
  return mesh;
}

}  // namespace

TEST(Repair, OrientTurnsWhatIsWoundWrong) {
  const SurfaceMesh ball = ballMesh(1, 3);
  SurfaceMesh mesh = ball;
  uint64_t turned = 0;
  for (size_t f = 0; f < mesh.triangles.size(); f += 3) std::swap(mesh.triangles[f][0], mesh.triangles[f][1]), ++turned;
  const SurfaceMesh broken = mesh;
  EXPECT_EQ(repaired(mesh, {true, false}).turned_triangles, turned);
  expectSameTriangles(mesh, broken);
  EXPECT_EQ(findDefects(mesh).unmatched_edges, 0U);
  EXPECT_NEAR(signedVolume(mesh), signedVolume(ball), 1e-5);
}

// Two thirds turned: the majority is wrong, and still the outside is outside.
TEST(Repair, OrientLeadsOutwardsWhateverTheMajority) {
  SurfaceMesh mesh = ballMesh(1, 3);
  for (size_t f = 0; f < mesh.triangles.size(); ++f)
    if (f % 3 != 0) std::swap(mesh.triangles[f][0], mesh.triangles[f][1]);
  repaired(mesh, {true, false});
  EXPECT_GT(signedVolume(mesh), 4);
  SurfaceMesh inside_out = ballMesh(1, 2);
  reverse(inside_out);
  EXPECT_EQ(repaired(inside_out, {true, false}).turned_triangles, inside_out.triangles.size());
  EXPECT_GT(signedVolume(inside_out), 3.5);
}

// A flat sheet bounds no volume, so there is no outside to face: most of its triangles decide, wherever the others are in the list.
TEST(Repair, OrientKeepsTheFaceOfMostOfAFlatSheet) {
  SurfaceMesh sheet;
  for (int i = 0; i < 25; ++i) sheet.positions.push_back({float(i % 5), 2, -float(i / 5)});
  for (uint32_t row = 0; row < 4; ++row)
    for (uint32_t column = 0; column < 4; ++column) {
      const uint32_t a = 5 * row + column;
      sheet.triangles.insert(sheet.triangles.end(), {{a, a + 1, a + 6}, {a, a + 6, a + 5}});
    }
  // Tilted and moved, where rounding leaves it a volume of either sign.
  for (int tilt = 0; tilt < 24; ++tilt) {
    const float angle = 0.3F * float(tilt), cosine = std::cos(angle), sine = std::sin(angle);
    const Vec3 normal{-sine, cosine, 0};
    SurfaceMesh mesh = sheet;
    for (Vec3& p : mesh.positions) p = Vec3{cosine * p.x - sine * p.y, sine * p.x + cosine * p.y, p.z} + Vec3{1, 3, -2} * float(tilt % 4);
    uint64_t turned = 0;
    for (size_t f = size_t(tilt % 3); f < mesh.triangles.size(); f += 3) std::swap(mesh.triangles[f][0], mesh.triangles[f][1]), ++turned;
    EXPECT_EQ(repaired(mesh, {true, false}).turned_triangles, turned) << tilt;
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3 across = cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
      EXPECT_NEAR(dot(across, normal), 1, 1e-4) << tilt;
    }
  }
}

// A cavity that the sculptor made stays one; a ball in a ball stays solid (overlapping shells count once); what is mixed leads outwards.
TEST(Repair, OrientKeepsCavities) {
  SurfaceMesh inner = ballMesh(0.5F, 2);
  const SurfaceMesh solid = merged(ballMesh(1, 3), inner);
  reverse(inner);
  const SurfaceMesh hollow = merged(ballMesh(1, 3), inner);
  for (const SurfaceMesh& source : {solid, hollow}) {
    SurfaceMesh mesh = source;
    EXPECT_EQ(repaired(mesh, {true, false}).turned_triangles, 0U);
    EXPECT_EQ(mesh.triangles, source.triangles);
  }
  SurfaceMesh mixed = hollow;
  std::swap(mixed.triangles.back()[0], mixed.triangles.back()[1]);
  repaired(mixed, {true, false});
  EXPECT_NEAR(signedVolume(mixed), signedVolume(solid), 1e-5);
}

TEST(Repair, OrientLeavesDegenerateAndNonManifoldTrianglesInPlace) {
  SurfaceMesh mesh = merged(boxMesh({0, 0, 0}, {1, 1, 1}), boxMesh({1, 1, 0}, {2, 2, 1}));  // share an edge: four triangles
  mesh.triangles.push_back({3, 3, 5});
  std::swap(mesh.triangles[2][0], mesh.triangles[2][1]);
  const SurfaceMesh broken = mesh;
  EXPECT_EQ(repaired(mesh, {true, false}).turned_triangles, 1U);
  expectSameTriangles(mesh, broken);
  EXPECT_EQ(mesh.triangles.back(), (Triangle{3, 3, 5}));
  EXPECT_EQ(findDefects(mesh).unmatched_edges, 0U);
}

// Holes of a ball: closed by triangles between the vertices that are there, and nearly the volume of the ball's flat-topped rest.
TEST(Repair, FillClosesHoles) {
  SurfaceMesh mesh = withHoleAbove(ballMesh(1, 4), 0.8F);
  const SurfaceMesh open = mesh;
  ASSERT_GT(findDefects(mesh).open_edges.count, 8U);
  const RepairSummary summary = repaired(mesh, {false, true});
  EXPECT_EQ(summary.filled_holes, 1U);
  EXPECT_EQ(summary.added_triangles, findDefects(open).open_edges.count - 2);
  expectSameTriangles(mesh, open);
  EXPECT_EQ(findDefects(mesh).unmatched_edges, 0U);
  const double height = 0.2, cap = double(kPi) * height * height * (1 - height / 3);
  EXPECT_NEAR(signedVolume(mesh), 4 * double(kPi) / 3 - cap, 0.06);
}

// A flat round hole has as many equally good triangulations as there are: which one is taken must not depend on where memory lies.
TEST(Repair, FillIsTheSameWhereverMemoryLies) {
  const SurfaceMesh cone = openCone(64);
  uint64_t holes = 0;
  const auto first = closedByFilling(cone, holes);
  ASSERT_TRUE(first);
  std::vector<std::vector<char>> elsewhere;
  for (size_t run = 1; run < 20; ++run) {
    for (size_t block = 0; block < 50; ++block) elsewhere.emplace_back(64 * ((run * 37 + block * 11) % 97 + 1));
    if (run % 3 == 0) elsewhere.resize(elsewhere.size() / 2);
    EXPECT_EQ(closedByFilling(cone, holes)->triangles, first->triangles);
  }
}

// Longer loops than every triangulation is searched for.
TEST(Repair, FillClosesLongLoops) {
  for (const int n : {149, 150, 151, 700, 5000, 40000}) {
    const SurfaceMesh cone = openCone(n);
    uint64_t holes = 0;
    const auto closed = closedByFilling(cone, holes);
    ASSERT_TRUE(closed) << n;
    EXPECT_EQ(holes, 1U);
    EXPECT_EQ(closed->triangles.size(), size_t(n) + size_t(n) - 2);
    // A cone of height 1 over a circle of radius 1.
    EXPECT_NEAR(signedVolume(*closed), kPi / 3, 30.0 / n / n) << n;
  }
}

TEST(Repair, FillClosesEveryHoleOfARaggedMesh) {
  SurfaceMesh mesh = ballMesh(1, 4);
  size_t n = 0;
  std::erase_if(mesh.triangles, [&](const Triangle&) { return n++ % 7 == 0; });
  const SurfaceMesh open = mesh;
  EXPECT_GT(repaired(mesh, {false, true}).filled_holes, 100U);
  EXPECT_EQ(findDefects(mesh).unmatched_edges, 0U);
  EXPECT_NEAR(signedVolume(mesh), signedVolume(ballMesh(1, 4)), 0.02);
  uint64_t holes = 0;
  const auto closed = closedByFilling(open, holes);
  ASSERT_TRUE(closed);
  EXPECT_EQ(closed->triangles, mesh.triangles);
}

// A triangle joins vertices of one part; a hole with others beside it stays, and is told.
TEST(Repair, FillJoinsNoParts) {
  SurfaceMesh mesh = withHoleAbove(ballMesh(1, 3), 0.8F);
  std::vector<uint32_t> parts(mesh.positions.size(), 0);
  Warnings warnings;
  for (size_t v = 0; v < parts.size(); ++v) parts[v] = mesh.positions[v].x > 0;
  EXPECT_EQ(repaired(mesh, {false, true}, parts, &warnings).filled_holes, 0U);
  EXPECT_EQ(warnings.entries().at(WarningKind::kHoleNotFilled).count, 1U);
}

TEST(Repair, FillAfterOrientWhereWindingsDisagree) {
  SurfaceMesh mesh = withHoleAbove(ballMesh(1, 3), 0.7F);
  for (size_t f = 0; f < mesh.triangles.size(); f += 2) std::swap(mesh.triangles[f][0], mesh.triangles[f][1]);
  const SurfaceMesh broken = mesh;
  repaired(mesh, {true, true});
  EXPECT_EQ(findDefects(mesh).unmatched_edges, 0U);
  EXPECT_GT(signedVolume(mesh), 3.5);
  uint64_t holes = 0;
  EXPECT_TRUE(closedByFilling(broken, holes));
  EXPECT_EQ(holes, 1U);
}

// A Möbius band has one side: no winding agrees, and its rim is one loop; the wrap is left for it.
TEST(Repair, OneSidedBandsAreNotClosedByFilling) {
  SurfaceMesh band;
  constexpr int kSteps = 40;
  for (int i = 0; i < kSteps; ++i) {
    const double turn = 2 * double(kPi) * i / kSteps;
    for (const double s : {-0.3, 0.3})
      band.positions.push_back({float((1 + s * std::cos(turn / 2)) * std::cos(turn)), float(s * std::sin(turn / 2)),
                                float((1 + s * std::cos(turn / 2)) * std::sin(turn))});
  }
  for (uint32_t i = 0; i < kSteps; ++i) {
    const uint32_t a = 2 * i, b = 2 * i + 1;
    const uint32_t c = i + 1 < kSteps ? 2 * i + 2 : 1, d = i + 1 < kSteps ? 2 * i + 3 : 0;
    band.triangles.insert(band.triangles.end(), {{a, b, c}, {b, d, c}});
  }
  uint64_t holes = 0;
  EXPECT_FALSE(closedByFilling(band, holes));
  EXPECT_GT(wrapClosed(band, 0.1).volume, 0);
}

// A lens-shaped body, a sixtieth as thick as it is wide: every finer wrap holds much less than the coarser, and none is hollow.
TEST(Repair, WrapsOfThinBodiesGoOn) {
  SurfaceMesh lens = ballMesh(1, 4);
  for (Vec3& p : lens.positions) p.y /= 60;
  std::swap(lens.triangles[0][0], lens.triangles[0][1]);
  const double volume = 4 * double(kPi) / 3 / 60;
  const double wrapped = wrapClosed(lens, 0.02).volume;
  EXPECT_GT(wrapped, volume);
  EXPECT_LT(wrapped, 2 * volume);
}

// Half a ball without its disc: a hole of 2R. Finer balls would hollow it out to a shell of no volume; the wrap is solid, 2π/3 R³.
TEST(Repair, HalfBallBecomesSolid) {
  const SurfaceMesh bowl = bowlMesh();
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

// A cone without its base, as one fan about its tip, or with all its triangles a thousand times: π/3 r² h.
TEST(Repair, FansOfManyTrianglesAreWrapped) {
  const auto cone = [](uint32_t rim, int times) {
    SurfaceMesh mesh;
    mesh.positions.push_back({0, 1, 0});
    for (uint32_t i = 0; i < rim; ++i) {
      const double angle = 2 * double(kPi) * i / rim;
      mesh.positions.push_back({float(std::cos(angle)), 0, float(std::sin(angle))});
    }
    for (int n = 0; n < times; ++n)
      for (uint32_t i = 0; i < rim; ++i) mesh.triangles.push_back({1 + (i + 1) % rim, 1 + i, 0});
    return mesh;
  };
  for (const SurfaceMesh& mesh : {cone(60'000, 1), cone(60, 1000)}) EXPECT_NEAR(wrapClosed(mesh, 0.1).volume, double(kPi) / 3, 0.4);
}

TEST(Repair, NothingCannotBeWrapped) {
  SurfaceMesh point;
  point.positions = {{1, 1, 1}};
  point.triangles = {{0, 0, 0}};
  EXPECT_THROW(wrapClosed(point, 1), InputError);
}

// A torus of long thin triangles, split along every edge: closed, even, as fine as asked for, of the same volume, at every size and place.
TEST(Repair, RemeshedTrianglesAreEven) {
  for (const float size : {1e-6F, 1.0F, 1e6F}) {
    SurfaceMesh torus = torusMesh(1, 0.4F, 300, 24), split;
    for (const Triangle& t : torus.triangles) {
      const auto first = uint32_t(split.positions.size());
      for (const uint32_t v : t) split.positions.push_back(torus.positions[v] * size + Vec3{3 * size, 0, 0});
      split.triangles.push_back({first, first + 1, first + 2});
    }
    const double edge = 0.08 * double(size);
    const SurfaceMesh mesh = remeshed(split, edge);
    const std::vector<double> lengths = edgeLengths(mesh);
    EXPECT_NEAR(lengths[lengths.size() / 2] / edge, 1, 0.15);  // CGAL's bounds are 4/5 and 4/3
    EXPECT_GT(lengths[lengths.size() / 20] / edge, 0.7);
    EXPECT_LT(lengths.back() / edge, 1.6);
    const MeshDefects defects = findDefects(mesh);
    EXPECT_EQ(defects.unmatched_edges + defects.non_manifold_edges.count + defects.degenerate_triangles.count +
                  defects.unreferenced_vertices.count,
              0U);
    EXPECT_NEAR(signedVolume(mesh) / signedVolume(split), 1, 0.01);
  }
}

// Fine border edges stay as they are; long ones are cut where they lie, so that no border point leaves the old one.
TEST(Repair, RemeshingKeepsBorders) {
  const SurfaceMesh bowl = bowlMesh();
  const auto before = borderOf(bowl), after = borderOf(remeshed(bowl, 0.2));
  ASSERT_GT(before.size(), 60U);
  EXPECT_EQ(after.size(), before.size());
  for (const auto& edge : after) {
    const auto near = [&](const auto& other) {
      return std::equal(edge.begin(), edge.end(), other.begin(), [](float a, float b) { return std::fabs(a - b) < 1e-6F; });
    };
    EXPECT_TRUE(std::any_of(before.begin(), before.end(), near));
  }

  const SurfaceMesh square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {9, 9, 9}}, {}, {{0, 1, 2}, {0, 2, 3}}};
  const SurfaceMesh fine = remeshed(square, 0.1);
  EXPECT_GE(borderOf(fine).size(), 40U);
  double area = 0;
  for (const auto& [a, b, c] : fine.triangles)
    area += 0.5 * double(cross(fine.positions[b] - fine.positions[a], fine.positions[c] - fine.positions[a]).z);
  EXPECT_NEAR(area, 1, 1e-5);
  EXPECT_EQ(findDefects(fine).unreferenced_vertices.count, 0U);
  EXPECT_LT(edgeLengths(fine).back(), 0.16);
}

TEST(Repair, RemeshingRefusesByReason) {
  const auto refusal = [](const SurfaceMesh& mesh, double edge) -> std::string {
    try {
      remeshed(mesh, edge);
    } catch (const InputError& error) {
      return error.message;
    }
    return "";
  };
  const SurfaceMesh ball = ballMesh(1, 3);
  SurfaceMesh fin = ball, turned = ball;
  fin.positions.push_back({0, 3, 0});
  fin.triangles.push_back({ball.triangles[0][0], ball.triangles[0][1], uint32_t(ball.positions.size())});
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  const SurfaceMesh touching = merged(boxMesh({0, 0, 0}, {1, 1, 1}), boxMesh({1, 1, 1}, {2, 2, 2}));
  EXPECT_NE(refusal(fin, 0.1).find("1 edges have more than two triangles"), std::string::npos);
  EXPECT_NE(refusal(fin, 0.1).find("--vertices N"), std::string::npos);
  EXPECT_NE(refusal(turned, 0.1).find("opposite winding"), std::string::npos);
  EXPECT_NE(refusal(touching, 0.1).find("touch in a point"), std::string::npos);
  EXPECT_NE(refusal(ball, 1e-4).find("longer edge"), std::string::npos);
  EXPECT_NE(refusal(ball, 2).find("shorter edge"), std::string::npos);
  EXPECT_NE(refusal({{{1, 1, 1}}, {}, {{0, 0, 0}}}, 1).find("extent"), std::string::npos);
  EXPECT_EQ(refusal(ball, 0.2), "");
}

TEST(Repair, RemeshingRepeats) {
  const SurfaceMesh once = remeshed(ballMesh(1, 4), 0.1), again = remeshed(ballMesh(1, 4), 0.1);
  EXPECT_EQ(once.positions, again.positions);
  EXPECT_EQ(once.triangles, again.triangles);
}

#else

TEST(Repair, RefusesByNameWithoutCgal) {
  EXPECT_FALSE(hasCgal());
  EXPECT_THROW(wrapClosed(ballMesh(1, 1), 0.1), InputError);
  EXPECT_THROW(remeshed(ballMesh(1, 3), 0.1), InputError);
}

#endif

// Triangles with three distinct corners on one line have no area, and nothing of them can be wrapped.
TEST(Repair, TrianglesWithoutAreaAreNothingToWrap) {
  if (!hasCgal()) GTEST_SKIP();
  SurfaceMesh needles;
  for (int k = 0; k < 6; ++k) needles.positions.push_back({0, float(k), 0});
  needles.triangles = {{0, 1, 2}, {2, 3, 5}, {1, 4, 5}};
  EXPECT_THROW(wrapClosed(needles, 0.1), InputError);
}
