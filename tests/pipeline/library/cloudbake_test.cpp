// The library bakes what the command line bakes.
#include "pipeline/library/cloudbake.h"

#include <algorithm>
#include <limits>

#include "bake/field/level_set.h"
#include "bake/mesh/repair.h"
#include "core/parallel.h"
#include "io/file/write_file.h"
#include "io/gltf/asset/decode.h"
#include "io/volume/vdb.h"
#include "pipeline/asset/asset.h"
#include "pipeline/options/presets.h"
#include "pipeline/options/resolve.h"
#include "pipeline/sources/grown.h"
#include "tests/io/io_helpers.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

namespace fs = std::filesystem;

const Options kFew{{"rays", "16"}, {"voxels", "16"}};

SurfaceMesh box() { return boxMesh({0, 0, 0}, {1, 2, 1}); }
Options with(Options options, const std::string& name, const std::string& value) {
  options.emplace_back(name, value);
  return options;
}

// Of a ball the mean lobe is known: inwards, and as thick as the ball.
TEST(Cloudbake, BakesAMesh) {
  const SurfaceMesh mesh = ballMesh(2, 2, {5, 0, 0});
  const BakeResult baked = bake(mesh, {{"lobe", "mean"}, {"rays", "400"}, {"voxels", "32"}});
  ASSERT_EQ(baked.lobes.size(), mesh.positions.size());
  for (size_t v = 0; v < baked.lobes.size(); ++v) {
    const Lobe ball = ballLobe(mesh.positions[v], {5, 0, 0}, 2);
    ASSERT_LT(angleDegrees(baked.lobes[v].direction, ball.direction), 4) << v;
    ASSERT_NEAR(baked.lobes[v].thickness, ball.thickness, 0.1 * ball.thickness) << v;
  }
  EXPECT_FLOAT_EQ(baked.info.extinction, 7.0F / 4);
  EXPECT_TRUE(baked.warnings.empty());
}

// The report is that of --json, the summary that of the terminal, and every stage is told when it ends.
TEST(Cloudbake, ReportsWhatItDid) {
  std::vector<std::string> stages;
  const BakeResult baked = bake(box(), with(kFew, "lobe", "fit"), [&](const std::string& stage) { stages.push_back(stage); });
  EXPECT_NE(baked.report.find("\"schema\": \"cloudbake-report-1\""), std::string::npos);
  EXPECT_NE(baked.report.find("\"command\": \"bake\""), std::string::npos);
  EXPECT_NE(baked.summary.find("16 directions"), std::string::npos);
  for (const char* stage : {"read", "check", "field", "bake", "fit"})
    EXPECT_NE(std::find(stages.begin(), stages.end(), stage), stages.end()) << stage;
}

TEST(Cloudbake, BakesAFileToTheBytesOfTheCommand) {
  const TestFolder folder;
  const fs::path file = folder.write("a.obj", objText(box()));
  Settings settings = settingsFor({"rays=16", "voxels=16"}, SourceKind::kSculpt, file);
  settings.output.file = folder.path / "out.glb";
  BakeReport report;
  Stopwatch watch;
  writeAsset(readCloud(settings, report, watch), settings, report, watch);
  const BakeResult baked = bake(file, kFew);
  EXPECT_EQ(baked.glb, readFileBytes(folder.path / "out.glb"));
  EXPECT_EQ(baked.info.input_hash, hashBytes(readFileBytes(file)));
  EXPECT_EQ(baked.info.rays, 16);
}

TEST(Cloudbake, BakesAVdb) {
  const TestFolder folder;
  LevelSetSettings settings;
  settings.voxel_size = 0.2F;
  Warnings warnings;
  const fs::path file = folder.write("puff.VDB", encodeVdb(levelSetFromMesh(ballMesh(1, 3), settings, warnings)));
  const BakeResult baked = bake(file, {{"rays", "16"}});
  EXPECT_GT(baked.lobes.size(), 100U);
  for (const Vec3& p : readAsset(baked.glb).surface.positions) ASSERT_NEAR(length(p), 1, 0.1);
  const fs::path sculpt = folder.write("a.obj", objText(box()));
  expectError<UsageError>([&] { bake(sculpt, {{"grid", "density"}}); }, "--grid does not apply to a sculpt");
}

TEST(Cloudbake, GrowsACloudToTheBytesOfTheCommand) {
  const TestFolder folder;
  SourceSettings source;
  source.input = "puffball", source.kind = SourceKind::kPreset;
  GrownSource grown = readGrownSource(source);
  std::vector<Given> given = grown.given;
  for (const auto& [name, value] : Options{{"vertices", "200"}, {"voxels", "24"}, {"seed", "3"}})
    given.push_back({findOption(name, kGrow), value, "", 0, 0});
  Settings settings = resolve(source, given);
  settings.output.file = folder.path / "out.glb";
  BakeReport report;
  Stopwatch watch;
  const Cloud cloud = growCloud(std::move(grown), settings, std::nullopt, report, watch);
  writeAsset(cloud, settings, report, watch);
  const BakeResult baked = grow("puffball", {{"vertices", "200"}, {"voxels", "24"}, {"seed", "3"}});
  EXPECT_EQ(baked.glb, readFileBytes(folder.path / "out.glb"));
  EXPECT_EQ(baked.lobes.size(), cloud.surface.positions.size());
  EXPECT_NE(baked.report.find("\"command\": \"grow\""), std::string::npos);
}

// A recipe's own options hold unless others are given; spheres and rules are known by their extensions.
TEST(Cloudbake, GrowsFiles) {
  const TestFolder folder;
  std::string text = *findPreset("puffball");
  const fs::path recipe = folder.write("a.toml", text.insert(text.find("[bake]\n") + 7, "rays = 24\nvertices = 200\n"));
  EXPECT_EQ(grow(recipe).info.rays, 24);
  EXPECT_EQ(grow(recipe, {{"rays", "16"}}).info.rays, 16);
  const fs::path spheres = folder.write("two.CSV", "x,y,z,radius\n0,0,0,1\n1,0,0,1\n");
  EXPECT_EQ(grow(spheres, kFew).lobes.size(), readAsset(grow(spheres, kFew).glb).lobes.size());
  EXPECT_GT(grow(folder.write("a.txt", "premise: F\nF = FF\n"), with(kFew, "generations", "2")).lobes.size(), 10U);
}

TEST(Cloudbake, GrowthsThatAreRefused) {
  EXPECT_NE(refusalOf<InputError>([] { grow("humils"); }).find("neither a preset nor a .toml file"), std::string::npos);
  EXPECT_FALSE(refusalOf<IoError>([] { grow("no.csv"); }).empty());
  expectError<UsageError>([] { grow("puffball", {{"dry-run", "true"}}); }, "--dry-run makes no asset");
  for (const char* name : {"rules", "from-spheres", "spheres", "vdb", "units", "nope"})
    expectError<UsageError>([&] { grow("puffball", {{name, "1"}}); }, "unknown option '" + std::string(name) + "'");
}

// A listener that throws ends the bake at the next stage.
TEST(Cloudbake, EndsWithWhatTheListenerThrows) {
  int stages = 0;
  const auto refuse = [&](const std::string&) {
    ++stages;
    throw LoopStopped();
  };
  EXPECT_THROW(bake(box(), kFew, refuse), LoopStopped);
  EXPECT_EQ(stages, 1);
}

// Long work outside of the loops asks whether it is to stop: a derivation before it ends its stage, and CGAL's remesh.
TEST(Cloudbake, WorkThatIsNoLoopIsStopped) {
  LoopStop stop;
  const LoopStop::Scope scope(stop);
  stop.request();
  int stages = 0;
  EXPECT_THROW(grow("puffball", kFew, [&](const std::string&) { ++stages; }), LoopStopped);
  EXPECT_EQ(stages, 0);
#ifdef CLOUDBAKE_CGAL
  EXPECT_THROW(remeshed(ballMesh(1, 1), 0.2), LoopStopped);
#endif
}

// The plan of a call has the stages of the call, in their order, and the share of the work never falls.
TEST(Cloudbake, ProgressNamesTheStageThatEndsNext) {
  const auto stagesOf = [](const auto& call) {
    LoopProgress progress;
    const LoopProgress::Scope scope(progress);
    std::vector<std::string> stages;
    double share = 0;
    call([&](const std::string& stage) {
      stages.push_back(stage);
      EXPECT_EQ(progress.stage(), stage);
      EXPECT_GE(progress.share(), share);
      share = progress.share();
      EXPECT_LE(share, 1);
    });
    EXPECT_GT(share, 0.5);
    return stages;
  };
  for (const auto& option : Options{{"lobe", "mean"},
                                    {"lobe", "fit"},
                                    {"basis", "sh1"},
                                    {"smooth", "2"},
                                    {"inspect", "true"},
                                    {"repair", "orient"},
                                    {"vertices", "6"},
                                    {"remesh", "30%"},
                                    {"refine", "0.5"},
                                    {"method", "rays"}})
    stagesOf([&](const StageListener& listener) { bake(box(), with(kFew, option.first, option.second), listener); });
  EXPECT_EQ(stagesOf([](const StageListener& listener) { bake(box(), with(kFew, "lobe", "mean"), listener); }),
            (std::vector<std::string>{"read", "check", "check", "field", "bake"}));
  stagesOf([](const StageListener& listener) { grow("puffball", with(kFew, "vertices", "200"), listener); });
}

// Vertices keep their number and order: a lobe for each, and the same in the asset.
TEST(Cloudbake, TheAssetHasTheLobesOfTheMesh) {
  const SurfaceMesh mesh = ballMesh(1, 1);
  const BakeResult baked = bake(mesh, kFew);
  const BakedMesh asset = readAsset(baked.glb);
  ASSERT_EQ(asset.surface.positions.size(), mesh.positions.size());
  for (size_t v = 0; v < mesh.positions.size(); ++v) ASSERT_LT(length(asset.surface.positions[v] - mesh.positions[v]), 1e-6) << v;
  EXPECT_EQ(asset.surface.triangles, mesh.triangles);
  // The lobes are the floats of the asset, to the last bit: there is nothing between the mesh and the scene.
  Warnings warnings;
  const StoredAsset stored = readStoredAsset("asset.glb", baked.glb, warnings);
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec2 first = stored.sets[0].at(0).values[v], second = stored.sets[0].at(1).values[v];
    ASSERT_EQ(first, (Vec2{baked.lobes[v].direction.x, baked.lobes[v].direction.y})) << v;
    ASSERT_EQ(second, (Vec2{baked.lobes[v].direction.z, baked.lobes[v].thickness})) << v;
  }
  ASSERT_EQ(asset.lobes.size(), baked.lobes.size());
  for (size_t v = 0; v < asset.lobes.size(); ++v) {
    ASSERT_LT(angleDegrees(asset.lobes[v].direction, baked.lobes[v].direction), 1e-3) << v;
    ASSERT_NEAR(asset.lobes[v].thickness, baked.lobes[v].thickness, 1e-5) << v;
  }
  EXPECT_EQ(asset.info.shape.exponent, baked.info.shape.exponent);
  EXPECT_EQ(asset.info.extinction, baked.info.extinction);
}

// --- Options ---

TEST(Cloudbake, OptionsAreThoseOfTheCommand) {
  const BakeResult plain = bake(box(), kFew);
  EXPECT_EQ(bake(box(), with(kFew, "rays", "36")).info.rays, 36) << "the last of several counts";
  EXPECT_EQ(bake(box(), with(kFew, "extinction", "2.5")).info.extinction, 2.5F);
  EXPECT_EQ(bake(box(), with(kFew, "lobe", "fit")).info.lobe, "fit");
  EXPECT_EQ(bake(box(), with(kFew, "bake_voxels", "10")).info.voxel_size, 0.2F) << "with _ as in TOML";
  EXPECT_TRUE(bake(box(), with(kFew, "separate", "true")).info.separate);
  EXPECT_FALSE(plain.info.separate);
  EXPECT_LE(readAsset(bake(ballMesh(1, 2), with(kFew, "vertices", "60")).glb).surface.positions.size(), 60U);
}

TEST(Cloudbake, OptionsThatAreRefused) {
  for (const char* name : {"units", "up", "allow-outside", "scene-index"})
    expectError<UsageError>(
        [&] {
          bake(box(), {{name, std::string(name) == "up" ? "y" : name[0] == 'a' ? "true" : "1"}});
        },
        "--" + std::string(name) + " is for files");
  for (const char* name : {"nope", "output", "o", "json", "lattice", "scene", "sun", "seeds", "--rays", ""})
    expectError<UsageError>([&] { bake(box(), {{name, "1"}}); }, "unknown option '" + std::string(name) + "'");
  expectError<UsageError>([] { bake(box(), {{"rays", "0"}}); }, "--rays");
  expectError<UsageError>([] { bake(box(), {{"rays", "many"}}); }, "--rays");
}

TEST(Cloudbake, TheSameBytesForAnyNumberOfThreads) {
  const BakeResult all = bake(box(), kFew);
  for (const char* count : {"1", "3"}) EXPECT_EQ(bake(box(), with(kFew, "threads", count)).glb, all.glb) << count;
}

// --- Warnings and errors ---

TEST(Cloudbake, WarningsAreCounted) {
  SurfaceMesh open = box();
  open.triangles.pop_back();
  const BakeResult baked = bake(open, kFew);
  const auto found =
      std::find_if(baked.warnings.begin(), baked.warnings.end(), [](const BakeWarning& w) { return w.kind == "open-edges"; });
  ASSERT_NE(found, baked.warnings.end());
  EXPECT_EQ(found->count, 3U);
  EXPECT_FALSE(found->first.empty());
  EXPECT_EQ(bake(box(), kFew).warnings.size(), 0U);
  expectError<InputError>([&] { bake(open, with(kFew, "strict", "true")); }, "mesh: --strict refuses open-edges");
}

TEST(Cloudbake, MeshesThatCannotBeUsed) {
  SurfaceMesh outside = box(), endless = box();
  outside.triangles[0][1] = 8;
  endless.positions[3].x = std::numeric_limits<float>::infinity();
  for (const SurfaceMesh& mesh : {SurfaceMesh{}, outside, endless}) {
    const std::string told = refusalOf<InputError>([&] { bake(mesh, kFew); });
    EXPECT_EQ(told.find("mesh: "), 0U) << told;
  }
}

TEST(Cloudbake, FilesThatCannotBeUsed) {
  const TestFolder folder;
  EXPECT_FALSE(refusalOf<IoError>([&] { bake(folder.path / "no.obj", kFew); }).empty());
  const std::string told = refusalOf<InputError>([&] { bake(folder.write("a.obj", "f 1 2 3\n"), kFew); });
  EXPECT_TRUE(contains(told, "a.obj")) << told;
}

TEST(Cloudbake, WhatIsNoAsset) {
  const std::string glb = bake(box(), kFew).glb;
  EXPECT_EQ(refusalOf<InputError>([&] { readAsset("text", "x.glb"); }).find("x.glb:1: "), 0U);
  EXPECT_EQ(refusalOf<InputError>([&] { readAsset(glb.substr(0, glb.size() / 2)); }).find("asset.glb: "), 0U);
}

TEST(Cloudbake, HasAVersion) { EXPECT_STREQ(version(), CLOUDBAKE_VERSION); }

}  // namespace
}  // namespace cloudbake
