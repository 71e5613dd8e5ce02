// Sculpts of few triangles: what blending costs them, and what splitting their edges wins back.
#include "pipeline/asset/refine.h"

#include <algorithm>
#include <cmath>

#include "bake/lobe/directions.h"
#include "bake/mesh/refine_mesh.h"
#include "bake/truth/error_metrics.h"
#include "core/lobe_lighting.h"
#include "core/parallel.h"
#include "core/surface_points.h"
#include "pipeline/asset/asset.h"
#include "pipeline/measure/oracle.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

SurfaceMesh cube() { return boxMesh({-1, -1, -1}, {1, 1, 1}); }
SurfaceMesh tetrahedron() {
  SurfaceMesh mesh;
  mesh.positions = {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  if (signedVolume(mesh) < 0) reverse(mesh);
  return mesh;
}

struct Refined {
  Cloud cloud;
  Settings settings;
  BakeReport report;
};
Refined refinedCloud(Cloud cloud, std::vector<std::string> texts) {
  texts.insert(texts.begin(), {"lobe=mean", "fit-to=transmittance"});  // unless a test chooses another
  texts.push_back("voxels=48");
  Refined r{std::move(cloud), settingsFor(texts), {}};
  Stopwatch watch;
  refineCloud(r.cloud, r.settings, r.report, watch);
  return r;
}
// The sculpt has no normals of its own, so that only its light counts.
Refined refined(const SurfaceMesh& mesh, std::vector<std::string> texts) {
  Cloud cloud = cloudOf(mesh);
  cloud.sculpt.parts[0].normals.clear();
  return refinedCloud(std::move(cloud), std::move(texts));
}

// What to do about a target that was not reached.
std::string adviceOf(const BakeReport& report) { return report.warnings.entries().at(WarningKind::kRefineTarget).first; }

uint64_t count(const BakeReport& report, WarningKind kind) {
  const auto found = report.warnings.entries().find(kind);
  return found == report.warnings.entries().end() ? 0 : found->second.count;
}

// The rms error over the surface: of T against exact chords or, where lobes are fitted to a volume, of its light against a march.
double surfaceRms(const Cloud& cloud, const Settings& settings) {
  const BakeParameters parameters = parametersFor(cloud, settings);
  BakeReport report;
  Stopwatch watch;
  const IntegrationField field = fieldOfCloud(cloud, settings, parameters, report, watch);
  const BakedLobes baked = lobesOfCloud(cloud, field, settings.lobe, parameters, report, watch);
  OracleQuestion question{
      .extinction = parameters.extinction, .ray_length = *parameters.bake.ray_length, .directions = 16, .over_surface = true};
  if (settings.lobe.fit_to_volume) question.volume = settings.lobe.volume.over({}), question.axes = sweepAxes(16);
  const Oracle oracle = askOracle(cloud, settings.field, settings.lobe.fit_to_volume ? 40 : 600, question);
  return compareOverSurface(oracle.surface.points, baked.lobes, baked.shape, bothSenses(oracle.axes), oracle.surface.light,
                            parameters.extinction)
      .per_pixel.rms;
}

// The rms error of T over the surface of a convex body, against the closed form: a ray ends at the nearest plane of a side that it leaves.
double convexRms(const Cloud& cloud, const Settings& settings, const SurfaceMesh& body) {
  const BakeParameters parameters = parametersFor(cloud, settings);
  BakeReport report;
  Stopwatch watch;
  const BakedLobes baked =
      lobesOfCloud(cloud, fieldOfCloud(cloud, settings, parameters, report, watch), settings.lobe, parameters, report, watch);
  const std::vector<Vec3> directions = fibonacciDirections(200);
  const std::vector<SurfacePoint> points = spreadOverSurface(cloud.surface, 1000);
  double sum = 0;
  for (const SurfacePoint& point : points)
    for (const Vec3& d : directions) {
      double chord = INFINITY;
      for (const Triangle& t : body.triangles) {
        const Vec3 a = body.positions[t[0]], n = *normalized(cross(body.positions[t[1]] - a, body.positions[t[2]] - a));
        if (dot(n, d) > 1e-6F)
          chord = std::min(chord, std::max(0.0, double(dot(n, a - valueAt(point, cloud.surface.positions)) / dot(n, d))));
      }
      const double error = lobeTransmittance(blendedLobe(point, baked.lobes), d, baked.shape, parameters.extinction) -
                           std::exp(-double(parameters.extinction) * chord);
      sum += error * error;
    }
  return std::sqrt(sum / double(points.size() * directions.size()));
}

// Every edge in 2^rounds pieces.
SurfaceMesh finer(SurfaceMesh mesh, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    const EdgeTable table = edgesOf(mesh, [&](uint32_t a, uint32_t b) { return 0.5F * (mesh.positions[a] + mesh.positions[b]); });
    splitEdges(mesh, table, std::vector<bool>(table.edges.size(), true));
  }
  mesh.normals.clear();
  return mesh;
}

void expectSameSurface(const SurfaceMesh& before, const SurfaceMesh& after) {
  EXPECT_NEAR(surfaceArea(after), surfaceArea(before), 1e-5 * surfaceArea(before));
  EXPECT_NEAR(signedVolume(after), signedVolume(before), 1e-5 * std::fabs(signedVolume(before)));
  EXPECT_EQ(findDefects(after).unmatched_edges, findDefects(before).unmatched_edges);
}

TEST(Refine, CubeAndTetrahedronGetAsGoodAsAMuchFinerMesh) {
  for (const auto& [lobe, method] : {std::pair("lobe=mean", "method=sweep"), {"lobe=fit", "method=sweep"}, {"lobe=fit", "method=rays"}})
    for (const SurfaceMesh& mesh : {cube(), tetrahedron()}) {
      const Refined r = refined(mesh, {"refine=auto", lobe, method});
      const double before = surfaceRms(cloudOf(mesh), r.settings), after = surfaceRms(r.cloud, r.settings),
                   limit = surfaceRms(cloudOf(finer(mesh, 4)), r.settings);
      EXPECT_LE(after, 1.15 * limit) << lobe << ", " << method << ", " << mesh.triangles.size() << " triangles, before " << before
                                     << ", vertices " << r.cloud.surface.positions.size();
      EXPECT_GT(before, (r.settings.lobe.fit ? 2 : 1) * limit);
      EXPECT_NEAR(convexRms(cloudOf(mesh), r.settings, mesh), before, 0.02 * before);
      EXPECT_NEAR(convexRms(r.cloud, r.settings, mesh), after, 0.02 * after);
      EXPECT_EQ(count(r.report, WarningKind::kRefineTarget), 0U);
      expectSameSurface(mesh, r.cloud.surface);
      ASSERT_TRUE(r.report.refine);
      EXPECT_EQ(r.report.refine->vertices_before, mesh.positions.size());
      EXPECT_EQ(r.report.refine->vertices_after, r.cloud.surface.positions.size());
      EXPECT_LE(r.report.refine->blending_after, r.report.refine->blending_before);
      EXPECT_TRUE(r.cloud.closed);
    }
}

TEST(Refine, AFitToAVolumeGetsBetterToo) {
  const Refined r = refined(cube(), {"refine=auto", "lobe=fit", "fit-to=volume", "rays=64"});
  const double before = surfaceRms(cloudOf(cube()), r.settings), after = surfaceRms(r.cloud, r.settings);
  EXPECT_LT(after, 0.4 * before) << "with " << r.cloud.surface.positions.size() << " vertices " << after;
  EXPECT_LT(r.cloud.surface.positions.size(), 200U);
  EXPECT_EQ(count(r.report, WarningKind::kRefineTarget), 0U);
  expectSameSurface(cube(), r.cloud.surface);
}

TEST(Refine, ATargetIsMetWithMoreVerticesWhereItIsLower) {
  size_t last = 0;
  double before = 0;
  for (const char* target : {"0.2", "0.1", "0.05"}) {
    const Refined r = refined(cube(), {std::string("refine=") + target, "lobe=fit"});
    EXPECT_LE(r.report.refine->blending_after, std::stod(target));
    EXPECT_GT(r.cloud.surface.positions.size(), last);
    if (last > 0) {
      EXPECT_EQ(r.report.refine->blending_before, before);
    }
    last = r.cloud.surface.positions.size(), before = r.report.refine->blending_before;
    EXPECT_GT(before, r.report.refine->blending_after);
  }
}

TEST(Refine, ATargetDoesNotDependOnTheSizeOfTheSculpt) {
  SurfaceMesh large = cube();
  for (Vec3& position : large.positions) position = position * 64.0F;
  const Refined of_small = refined(cube(), {"refine=0.1", "lobe=fit"}), of_large = refined(large, {"refine=0.1", "lobe=fit"});
  EXPECT_EQ(of_large.cloud.surface.triangles, of_small.cloud.surface.triangles);
}

TEST(Refine, BudgetIsKept) {
  const Refined r = refined(cube(), {"refine=0.0001", "vertices=100", "lobe=fit"});
  EXPECT_LE(r.cloud.surface.positions.size(), 100U);
  EXPECT_GT(r.cloud.surface.positions.size(), 80U);
  EXPECT_EQ(count(r.report, WarningKind::kRefineTarget), 1U);
  EXPECT_TRUE(adviceOf(r.report).ends_with("allow more --vertices")) << adviceOf(r.report);
  expectSameSurface(cube(), r.cloud.surface);
}

TEST(Refine, ABudgetThatIsJustEnoughIsEnough) {
  const Refined free = refined(cube(), {"refine=0.1", "lobe=fit"});
  const std::string vertices = "vertices=" + std::to_string(free.cloud.surface.positions.size());
  const Refined within = refined(cube(), {"refine=0.1", "lobe=fit", vertices});
  EXPECT_EQ(within.cloud.surface.triangles, free.cloud.surface.triangles);
  EXPECT_EQ(count(within.report, WarningKind::kRefineTarget), 0U);
}

// More vertices do not help where the lobes' own errors differ from one to the next.
TEST(Refine, StopsWhereLobesVaryTooMuch) {
  const Refined r = refined(tetrahedron(), {"refine=0.001", "method=rays", "rays=16"});
  EXPECT_LT(r.cloud.surface.positions.size(), 10000U);
  EXPECT_EQ(count(r.report, WarningKind::kRefineTarget), 1U);
  EXPECT_TRUE(adviceOf(r.report).ends_with("use more --rays")) << adviceOf(r.report);
}

TEST(Refine, ASculptOverTheBudgetKeepsItsVertices) {
  const TestFolder folder;
  const SurfaceMesh ball = ballMesh(1, 1);
  BakeReport report;
  Stopwatch watch;
  const Cloud cloud = readCloud(
      settingsFor({"refine=0.0001", "vertices=20", "voxels=24"}, SourceKind::kSculpt, folder.write("b.obj", objText(ball))), report, watch);
  EXPECT_EQ(cloud.surface.positions, ball.positions);
  EXPECT_EQ(count(report, WarningKind::kRefineTarget), 1U);
}

TEST(Refine, WhatNeedsNothingGetsNothing) {
  const SurfaceMesh ball = ballMesh(1, 3);
  const auto glbOf = [](const Refined& r) {
    BakeReport report;
    Stopwatch watch;
    return bakeAsset(r.cloud, r.settings, parametersFor(r.cloud, r.settings), report, watch).glb;
  };
  const Refined asked = refined(ball, {"refine=0.2"}), plain = refined(ball, {});
  EXPECT_EQ(glbOf(asked), glbOf(plain));
  EXPECT_EQ(asked.report.refine->vertices_after, ball.positions.size());
  EXPECT_EQ(asked.report.refine->blending_after, asked.report.refine->blending_before);
  EXPECT_FALSE(plain.report.refine);
  EXPECT_EQ(glbOf(refinedCloud(cloudOf(cube()), {})), glbOf(Refined{cloudOf(cube()), settingsFor({"voxels=48", "lobe=mean"}), {}}));
}

TEST(Refine, TheNumberOfThreadsDoesNotMatter) {
  const Refined all = refined(tetrahedron(), {"refine=0.05", "lobe=fit"});
  const ThreadLimit limit(1);
  const Refined one = refined(tetrahedron(), {"refine=0.05", "lobe=fit"});
  EXPECT_EQ(all.cloud.surface.positions, one.cloud.surface.positions);
  EXPECT_EQ(all.cloud.surface.triangles, one.cloud.surface.triangles);
  EXPECT_EQ(all.report.refine->blending_after, one.report.refine->blending_after);
}

TEST(Refine, TheOrderOfVerticesDoesNotMatter) {
  SurfaceMesh turned = tetrahedron();
  std::reverse(turned.positions.begin(), turned.positions.end());
  for (Triangle& t : turned.triangles) t = {3 - t[1], 3 - t[2], 3 - t[0]};
  std::reverse(turned.triangles.begin(), turned.triangles.end());
  const auto placesOf = [](const SurfaceMesh& mesh) {
    std::vector<std::array<float, 3>> places;
    for (const Vec3& p : refined(mesh, {"refine=0.05", "lobe=fit"}).cloud.surface.positions) places.push_back({p.x, p.y, p.z});
    std::sort(places.begin(), places.end());
    return places;
  };
  EXPECT_EQ(placesOf(tetrahedron()), placesOf(turned));
}

// A cube whose sides have vertices of their own, with UVs that are linear in the position on each side.
TEST(Refine, SeamsStayClosedAndAttributesAreLinear) {
  SculptPart part = partOf(cube(), "cube", 0);
  SculptPart seamed = part;
  seamed.positions.clear(), seamed.triangles.clear();
  for (const Triangle& t : part.triangles) {
    const auto first = uint32_t(seamed.positions.size());
    for (const uint32_t v : t) seamed.positions.push_back(part.positions[v]);
    seamed.triangles.push_back({first, first + 1, first + 2});
  }
  seamed.normals.clear();
  const auto uvAt = [](Vec3 p) { return Vec2{0.25F * p.x + 0.5F * p.y, p.z}; };
  const auto colorAt = [](Vec3 p) { return std::array<float, 4>{0.5F + 0.5F * p.x, 0.5F + 0.5F * p.y, 0.5F, 1}; };
  for (const Vec3& p : seamed.positions) {
    seamed.uvs.push_back(uvAt(p));
    seamed.colors.push_back(colorAt(p));
  }
  seamed.more_uvs = {seamed.uvs, seamed.uvs};
  seamed.to_scene.linear = {{{0, 0, 1.7}, {0, 1.1, 0}, {1.3, 0, 0}}};  // mirrored, with lengths that are no floats
  seamed.to_scene.offset = {0.1, 20, 3};
  Cloud cloud;
  cloud.sculpt.parts = {seamed};
  cloud.surface = surfaceInScene(cloud.sculpt);
  const Refined r = refinedCloud(cloud, {"refine=0.05", "lobe=fit"});
  const SculptPart& fine = r.cloud.sculpt.parts[0];
  ASSERT_GT(fine.midpoints.size(), 50U);
  EXPECT_EQ(fine.positions.size(), 36 + fine.midpoints.size());
  expectSameSurface(cloud.surface, r.cloud.surface);
  EXPECT_TRUE(r.cloud.closed);
  ASSERT_EQ(fine.uvs.size(), fine.positions.size());
  ASSERT_EQ(fine.more_uvs[1].size(), fine.positions.size());
  ASSERT_EQ(fine.colors.size(), fine.positions.size());
  for (size_t v = 0; v < fine.positions.size(); ++v) {
    EXPECT_EQ(fine.uvs[v], uvAt(fine.positions[v]));
    EXPECT_EQ(fine.more_uvs[1][v], fine.uvs[v]);
    EXPECT_EQ(fine.colors[v], colorAt(fine.positions[v]));
  }
}

// On an octahedron with one normal per corner, blended normals point away from the middle. An engine blends the normals of the refined
// mesh, which have unit length, to almost the same.
TEST(Refine, NormalsBetweenVerticesStay) {
  SurfaceMesh octahedron;
  octahedron.positions = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  octahedron.triangles = {{0, 1, 2}, {1, 3, 2}, {3, 4, 2}, {4, 0, 2}, {1, 0, 5}, {3, 1, 5}, {4, 3, 5}, {0, 4, 5}};
  Cloud cloud = cloudOf(octahedron);
  cloud.surface.normals = cloud.sculpt.parts[0].normals = octahedron.positions;
  const Refined r = refinedCloud(cloud, {"refine=0.05", "lobe=fit"});
  const SculptPart& fine = r.cloud.sculpt.parts[0];
  ASSERT_GT(fine.midpoints.size(), 50U);
  double largest = 0;
  for (size_t v = 0; v < fine.normals.size(); ++v) EXPECT_LT(angleDegrees(fine.normals[v], *normalized(fine.positions[v])), 1e-4);
  for (const Triangle& t : fine.triangles)
    for (const auto& corners : {std::vector{0, 1}, {1, 2}, {2, 0}, {0, 1, 2}}) {  // middles of edges, and of the triangle
      const auto between = [&](const std::vector<Vec3>& all) {
        Vec3 sum;
        for (const int corner : corners) sum += all[t[corner]];
        return *normalized(sum);
      };
      largest = std::max(largest, angleDegrees(between(fine.normals), between(fine.positions)));
    }
  EXPECT_LT(largest, 3 * 180 / kPi / 255) << "degrees: two steps of 8 bits, and half as much again inside a triangle";
  EXPECT_GT(largest, 0) << "edges are split no more than necessary";
}

TEST(Refine, PartsThatCannotBeRefinedStayAndAreCounted) {
  SurfaceMesh top = cube();
  for (Vec3& p : top.positions) p.y += 2;  // both have the square y = 1
  Cloud cloud;
  cloud.sculpt.parts = {partOf(cube(), "Body", 0), partOf(top, "Hat", 1)};
  cloud.sculpt.parts[1].fixed = "is skinned";
  cloud.surface = surfaceInScene(cloud.sculpt);
  const Refined r = refinedCloud(cloud, {"refine=0.05", "lobe=fit"});
  EXPECT_EQ(r.cloud.sculpt.parts[1].positions, top.positions);
  EXPECT_EQ(r.cloud.sculpt.parts[1].triangles, top.triangles);
  EXPECT_GT(r.cloud.sculpt.parts[0].positions.size(), 20U);
  EXPECT_GT(r.report.refine->blending_after, 0.1) << "the hat still errs";
  EXPECT_EQ(count(r.report, WarningKind::kPartNotRefined), 1U);
  EXPECT_EQ(r.report.warnings.entries().at(WarningKind::kPartNotRefined).first, "'Hat' is skinned: --refine leaves it as it is");
  expectSameSurface(cloud.surface, r.cloud.surface);
}

TEST(Refine, OpenSculptsAreClosedAsBefore) {
  SurfaceMesh open = cube();
  open.triangles.pop_back();
  const TestFolder folder;
  const auto file = folder.write("open.obj", objText(open));
  BakeReport report;
  Stopwatch watch;
  const Cloud cloud = readCloud(settingsFor({"refine=0.1", "voxels=48", "lobe=fit"}, SourceKind::kSculpt, file), report, watch);
  EXPECT_FALSE(cloud.closed);
  ASSERT_TRUE(cloud.filled);
  EXPECT_GT(cloud.surface.positions.size(), 20U);
  EXPECT_NEAR(signedVolume(*cloud.filled), 8, 1e-4);
  EXPECT_NEAR(surfaceArea(cloud.surface), 22, 1e-4);
}

}  // namespace
}  // namespace cloudbake
