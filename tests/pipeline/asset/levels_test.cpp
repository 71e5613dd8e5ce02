// Levels of detail shade like the full asset, keep what an artist made, and are files of their own.
#include "pipeline/asset/levels.h"

#include <algorithm>
#include <set>

#include "core/parallel.h"
#include "io/file/write_file.h"
#include "io/gltf/asset/decode.h"
#include "io/gltf/sculpt/read.h"
#include "pipeline/asset/asset.h"
#include "pipeline/sources/grown.h"
#include "tests/folders.h"
#include "tests/pipeline/shape_clouds.h"

namespace cloudbake {
namespace {

struct Leveled {
  BakeReport report;
  Settings settings;
  BakeParameters parameters;
  BakedAsset asset;
  BakedMesh level(size_t i) const {
    Warnings warnings;
    return decodeGlb("level.glb", asset.levels[i].glb, warnings);
  }
};
Leveled bakeLevels(const Cloud& cloud, std::vector<std::string> texts) {
  texts.insert(texts.begin(), {"lobe=mean", "fit-to=transmittance"});  // unless a test chooses another
  Leveled result;
  Stopwatch watch;
  result.settings = settingsFor(texts);
  result.settings.output.file = "out.glb";
  result.parameters = resolveParameters(cloud, result.settings, result.report, watch);
  result.asset = bakeAsset(cloud, result.settings, result.parameters, result.report, watch);
  return result;
}

// A torus as one part that is turned, mirrored and stretched, and cut by a seam of UVs.
Cloud seamedTorus() {
  SurfaceMesh mesh = torusMesh(1, 0.4F, 40, 20);
  std::vector<Vec2> uvs;
  for (const Vec3& p : mesh.positions) uvs.push_back({p.x, p.z});
  const size_t ring = 20, count = mesh.positions.size();
  for (size_t v = 0; v < ring; ++v) {  // the first ring again, for the triangles behind it
    const Vec3 p = mesh.positions[v], n = mesh.normals[v];
    mesh.positions.push_back(p), mesh.normals.push_back(n), uvs.push_back({p.x + 10, p.z});
  }
  for (Triangle& t : mesh.triangles)
    if (std::any_of(t.begin(), t.end(), [&](uint32_t v) { return v >= count - ring && v < count; }))
      for (uint32_t& v : t) v = v < ring ? uint32_t(count + v) : v;
  Affine node;
  node.linear = {{{-1.5, 0, 0}, {0, 0, -0.8}, {0, 0.7, 0}}};
  SculptPart part = partOf(mesh, "ring", 0, node);
  part.uvs = uvs;
  Cloud cloud;
  cloud.sculpt.parts.push_back(part);
  cloud.surface = surfaceInScene(cloud.sculpt);
  return cloud;
}

}  // namespace

TEST(Levels, FilesAreNamedAfterTheOutput) {
  EXPECT_EQ(levelFile("a/cloud.glb", 1), "a/cloud_lod1.glb");
  EXPECT_EQ(levelFile("x.y.GLB", 12), "x.y_lod12.GLB");
  EXPECT_EQ(levelFile("cloud", 2), "cloud_lod2");
}

// The lobes of a level are those that a bake of its vertices in the full field gives, and those of the exact ball.
TEST(Levels, HaveTheLobesOfTheFullBall) {
  const Cloud cloud = cloudOf(ballMesh(1, 4));
  const Leveled baked = bakeLevels(cloud, {"lods=50%,25%,10%", "voxels=60"});
  ASSERT_EQ(baked.asset.levels.size(), 3U);
  ASSERT_EQ(baked.report.levels.size(), 3U);
  const size_t counts[] = {1281, 640, 256};
  double before = 0;
  Warnings warnings;
  const IntegrationField field =
      buildField(cloud, fieldSettings(baked.settings.field, baked.parameters), baked.parameters.bake.method, warnings);
  for (size_t i = 0; i < 3; ++i) {
    const BakedMesh level = baked.level(i);
    const LevelFigures& figures = baked.report.levels[i];
    EXPECT_EQ(figures.vertices, counts[i]);
    EXPECT_EQ(level.surface.positions.size(), counts[i]);
    EXPECT_EQ(level.surface.triangles.size(), figures.triangles);
    const std::vector<Lobe> again = meanLobes({level.surface.positions, level.surface.normals}, field, baked.parameters.bake, warnings);
    for (size_t v = 0; v < level.lobes.size(); ++v) {
      const Vec3 p = level.surface.positions[v];
      EXPECT_NEAR(length(p), 1, 1e-5);
      EXPECT_LT(angleDegrees(level.lobes[v].direction, -p), 1.5) << v;
      EXPECT_NEAR(level.lobes[v].thickness, 2, 0.08) << v;
      EXPECT_LT(angleDegrees(level.lobes[v].direction, again[v].direction), 1e-3) << v;
      EXPECT_NEAR(level.lobes[v].thickness, again[v].thickness, 1e-5) << v;
    }
    EXPECT_EQ(level.info.shape.bias, baked.report.info.shape.bias);
    EXPECT_EQ(level.info.extinction, baked.report.info.extinction);
    std::printf("[  figures ] %5zu vertices: rms of T %.4f, distance rms %.5f, largest %.5f\n", counts[i], figures.transmittance_rms,
                figures.distance.rms, figures.distance.largest);
    EXPECT_GT(figures.transmittance_rms, before);
    EXPECT_GT(figures.distance.largest, figures.distance.rms);
    before = figures.transmittance_rms;
  }
  EXPECT_LT(before, 0.01);
  EXPECT_LT(baked.report.levels.back().distance.largest, 0.015);
}

TEST(Levels, OfAGrownCloudShadeLikeIt) {
  BakeReport report;
  Stopwatch watch;
  Settings settings = settingsFor({"lods=50%,20%", "voxels=40", "basis=sh1"}, SourceKind::kPreset, "humilis");
  settings.output.file = "out.glb";
  const Cloud cloud = growCloud(readGrownSource(settings.source), settings, {}, report, watch);
  const BakedAsset asset = bakeAsset(cloud, settings, resolveParameters(cloud, settings, report, watch), report, watch);
  Warnings warnings;
  const BakedMesh full = decodeGlb("full.glb", asset.glb, warnings), level = decodeGlb("level.glb", asset.levels[1].glb, warnings);
  EXPECT_LE(level.surface.positions.size(), full.surface.positions.size() / 5);
  EXPECT_EQ(findDefects(level.surface).unmatched_edges, findDefects(full.surface).unmatched_edges);
  ASSERT_EQ(level.harmonics.size(), 4 * level.lobes.size());
  for (size_t v = 0; v < level.lobes.size(); v += 7) {
    const auto found = std::find(full.surface.positions.begin(), full.surface.positions.end(), level.surface.positions[v]);
    ASSERT_NE(found, full.surface.positions.end());
    const auto at = size_t(found - full.surface.positions.begin());
    EXPECT_EQ(level.lobes[v].direction, full.lobes[at].direction);
    EXPECT_EQ(level.lobes[v].thickness, full.lobes[at].thickness);
    for (size_t c = 0; c < 4; ++c) EXPECT_EQ(level.harmonics[4 * v + c], full.harmonics[4 * at + c]);
  }
  for (const LevelFigures& figures : report.levels)
    std::printf("[  figures ] %5zu vertices: rms of T %.4f\n", size_t(figures.vertices), figures.transmittance_rms);
  EXPECT_LT(report.levels[0].transmittance_rms, 0.01);
  EXPECT_LT(report.levels[1].transmittance_rms, 0.02);
}

TEST(Levels, KeepSeamsUvsAndTheNode) {
  const Cloud cloud = seamedTorus();
  const Leveled baked = bakeLevels(cloud, {"lods=40%", "voxels=40"});
  Warnings warnings;
  const Sculpt sculpt = readGltf("level.glb", baked.asset.levels.at(0).glb, {}, warnings);
  std::filesystem::create_directories(glbFolder());
  writeFileAtomically(glbFolder() / "level.glb", baked.asset.levels[0].glb);
  ASSERT_EQ(sculpt.parts.size(), 1U);
  EXPECT_EQ(sculpt.parts[0].name, "ring");
  EXPECT_EQ(sculpt.parts[0].to_scene.linear, cloud.sculpt.parts[0].to_scene.linear);
  EXPECT_EQ(findDefects(surfaceInScene(sculpt)).unmatched_edges, 0U);
  EXPECT_GT(signedVolume(surfaceInScene(sculpt)), 0);
  const StoredAsset stored = readStoredAsset("level.glb", baked.asset.levels[0].glb, warnings);
  const std::vector<Vec2>& uvs = stored.sets.at(0).at(0).values;
  size_t beyond = 0;
  std::set<std::pair<float, float>> here, there;  // the two sides of the seam, at the same places
  for (size_t v = 0; v < uvs.size(); ++v) {
    const Vec3 p = sculpt.parts[0].positions[v];
    const bool is_beyond = uvs[v].x > 5;
    beyond += is_beyond;
    EXPECT_EQ(uvs[v].x, is_beyond ? p.x + 10 : p.x);
    EXPECT_EQ(uvs[v].y, p.z);
    if (p.z == 0 && p.x > 0) (is_beyond ? there : here).emplace(p.x, p.y);
  }
  EXPECT_GT(beyond, 3U);
  EXPECT_LT(beyond, 20U);
  EXPECT_EQ(here, there);
}

// A vertex per corner, as in an STL: they count as one where nothing tells them apart.
TEST(Levels, VerticesThatRepeatOthersGo) {
  const SurfaceMesh ball = ballMesh(1, 3);
  SurfaceMesh soup;
  for (const Triangle& t : ball.triangles) {
    const auto first = uint32_t(soup.positions.size());
    for (const uint32_t v : t) soup.positions.push_back(ball.positions[v]), soup.normals.push_back(ball.normals[v]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  const Leveled baked = bakeLevels(cloudOf(soup), {"lods=300", "voxels=30"});
  EXPECT_EQ(baked.report.levels.at(0).vertices, 300U);
  EXPECT_TRUE(baked.report.warnings.entries().empty());
}

TEST(Levels, PartsThatAreMovedStayWhole) {
  Cloud cloud;
  cloud.sculpt.parts = {partOf(ballMesh(1, 3), "rigid", 0), partOf(ballMesh(1, 3, {3, 0, 0}), "skinned", 1)};
  cloud.sculpt.parts[1].vertex_to_scene.resize(642);
  cloud.surface = surfaceInScene(cloud.sculpt);
  const Leveled baked = bakeLevels(cloud, {"lods=60%,10%", "voxels=30"});
  EXPECT_EQ(baked.report.levels.at(0).vertices, 770U);
  EXPECT_GT(baked.report.levels.at(1).vertices, 642U);
  EXPECT_EQ(baked.report.warnings.entries().at(WarningKind::kPartKept).count, 1U);
  EXPECT_EQ(baked.report.warnings.entries().at(WarningKind::kVertexBudget).count, 1U);
  EXPECT_TRUE(contains(baked.report.warnings.entries().at(WarningKind::kPartKept).first, "'skinned'"));
}

TEST(Levels, AreTheSameForAnyNumberOfThreads) {
  const Cloud cloud = seamedTorus();
  const Leveled many = bakeLevels(cloud, {"lods=50%,20%", "voxels=30"});
  const ThreadLimit limit(1);
  const Leveled one = bakeLevels(cloud, {"lods=50%,20%", "voxels=30"});
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(many.asset.levels[i].glb, one.asset.levels[i].glb);
    EXPECT_EQ(many.report.levels[i].transmittance_rms, one.report.levels[i].transmittance_rms);
  }
}

TEST(Levels, MustBeSmallerThanTheAsset) {
  EXPECT_TRUE(contains(refusalOf([] { bakeLevels(ball(), {"lods=642"}); }), "has 642 vertices"));
  EXPECT_EQ(bakeLevels(ball(), {"lods=641", "voxels=24"}).report.levels.size(), 1U);
}

}  // namespace cloudbake
