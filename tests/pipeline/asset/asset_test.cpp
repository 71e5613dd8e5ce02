// From a cloud to an asset: what is written decodes to what was baked, alone or in company.
#include "pipeline/asset/asset.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "io/file/write_file.h"
#include "io/gltf/asset/decode.h"
#include "io/gltf/sculpt/read.h"
#include "tests/io/io_helpers.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

namespace fs = std::filesystem;

Affine mirrored() {
  Affine node;
  node.linear = {{{-1.5, 0, 0}, {0, 0, -0.8}, {0, 0.7, 0}}};
  node.offset = {3, 1, 0};
  return node;
}

// A box, and a mirrored, turned and stretched copy that reaches into it.
std::vector<SculptPart> twoBoxes() {
  const SurfaceMesh box = boxMesh({0, 0, 0}, {2, 1, 1});
  return {partOf(box, "left", 0), partOf(box, "right", 1, mirrored())};
}

struct Written {
  BakeReport report;
  Cloud cloud;
  Settings settings;
  BakedMesh asset;
};
Written write(const TestFolder& folder, const fs::path& sculpt, std::vector<std::string> texts, const std::string& name = "out.glb") {
  texts.insert(texts.begin(), {"lobe=mean", "fit-to=transmittance"});  // unless a test chooses another
  Written written;
  Stopwatch watch;
  written.settings = settingsFor(texts, SourceKind::kSculpt, sculpt);
  written.settings.output.file = folder.path / name;
  written.cloud = readCloud(written.settings, written.report, watch);
  writeAsset(written.cloud, written.settings, written.report, watch);
  Warnings warnings;
  written.asset = decodeGlb(name, readFileBytes(folder.path / name), warnings);
  return written;
}

void expectSameLobes(const std::vector<Lobe>& lobes, const std::vector<Lobe>& expected) {
  ASSERT_EQ(lobes.size(), expected.size());
  for (size_t v = 0; v < lobes.size(); ++v) {
    ASSERT_LT(angleDegrees(lobes[v].direction, expected[v].direction), 1e-3) << v;
    ASSERT_NEAR(lobes[v].thickness, expected[v].thickness, 1e-5) << v;
  }
}

// The second route: field and lobes by hand, for the whole of the scene.
TEST(Asset, DecodesToTheLobesThatWereBaked) {
  const TestFolder folder;
  const Written w = write(folder, writeParts(folder, "a.glb", twoBoxes()), {"rays=36", "voxels=24", "seed=3"});
  Warnings warnings;
  const BakeParameters parameters = parametersFor(w.cloud, w.settings);
  const IntegrationField field = buildField(w.cloud, w.settings.field, Method::kSweep, warnings);
  expectSameLobes(w.asset.lobes, meanLobes({w.cloud.surface.positions, w.cloud.surface.normals}, field, parameters.bake, warnings));
  ASSERT_EQ(w.asset.surface.positions.size(), w.cloud.surface.positions.size());
  for (size_t v = 0; v < w.asset.surface.positions.size(); ++v)
    ASSERT_LT(length(w.asset.surface.positions[v] - w.cloud.surface.positions[v]), 1e-5);
}

// A level beyond those of this bake is reported, if a bake has made it. With --strict nothing is written then.
TEST(Asset, LevelsOfAnEarlierBakeAreReported) {
  const TestFolder folder;
  const fs::path sculpt = folder.write("a.obj", objText(ballMesh(1, 1)));
  const std::vector<std::string> texts{"rays=36", "voxels=24", "units=1", "up=y"};
  std::vector<std::string> leveled = texts, strict = texts;
  leveled.push_back("lods=30,20"), strict.push_back("strict");
  EXPECT_FALSE(write(folder, sculpt, leveled).report.warnings.entries().contains(WarningKind::kStaleLevel));
  folder.write("out_lod3.glb", "by an artist");
  const auto warnings = write(folder, sculpt, texts).report.warnings.entries();
  ASSERT_TRUE(warnings.contains(WarningKind::kStaleLevel));
  EXPECT_EQ(warnings.at(WarningKind::kStaleLevel).count, 2U);
  EXPECT_EQ(warnings.at(WarningKind::kStaleLevel).first,
            (folder.path / "out_lod1.glb").string() + ": this level of detail is of an earlier bake: remove it");
  EXPECT_THROW(write(folder, sculpt, strict), InputError);
}

// From the second bake on, a baked asset that is baked again gives the same bytes, with everything that a bake may write.
TEST(Asset, BakedAgainGivesTheSameBytes) {
  const TestFolder folder;
  const fs::path sculpt = folder.write("a.obj", objText(boxMesh({0, 0, 0}, {2, 1, 1})));
  for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{{}, {"attribute"}, {"basis=sh2"}, {"lobe=fit"}}) {
    std::vector<std::string> texts{"rays=36", "voxels=24"};
    texts.insert(texts.end(), more.begin(), more.end());
    EXPECT_EQ(write(folder, sculpt, texts, "1.glb").asset.info.input_hash, hashBytes(readFileBytes(sculpt)));
    write(folder, folder.path / "1.glb", texts, "2.glb");
    const Written third = write(folder, folder.path / "2.glb", texts, "3.glb");
    const std::string second = readFileBytes(folder.path / "2.glb");
    EXPECT_EQ(readFileBytes(folder.path / "1.glb").size(), second.size());
    EXPECT_EQ(readFileBytes(folder.path / "3.glb") == second, true);
    EXPECT_NE(third.asset.info.input_hash, hashBytes(second)) << "the lobes do not count";
  }
}

TEST(Asset, RecordsWhatWasDone) {
  const TestFolder folder;
  const fs::path sculpt = writeParts(folder, "a.glb", twoBoxes());
  const Written w = write(folder, sculpt, {"rays=36", "bake-voxels=20", "seed=3", "extinction=2"});
  EXPECT_EQ(w.report.input, sculpt.string());
  EXPECT_EQ(w.report.output, (folder.path / "out.glb").string());
  EXPECT_EQ(w.report.vertices, 16U);
  EXPECT_EQ(w.report.triangles, 24U);
  EXPECT_EQ(w.asset.info.input_hash, sourceHash(w.cloud.sculpt, "")) << "the boxes were baked before";
  EXPECT_EQ(w.asset.info.field, "coverage");
  EXPECT_FLOAT_EQ(w.asset.info.voxel_size, boundingBox(w.cloud.surface).longestSide() / 20);
  EXPECT_EQ(w.asset.info.rays, 36);
  EXPECT_EQ(w.asset.info.seed, 3U);
  EXPECT_EQ(w.asset.info.extinction, 2);
  EXPECT_EQ(w.asset.info.lobe, "mean");
  EXPECT_EQ(w.report.info.first_uv_set, 0);
  std::vector<std::string> stages;
  for (const auto& [stage, seconds] : w.report.seconds) stages.push_back(stage);
  EXPECT_EQ(stages, (std::vector<std::string>{"read", "check", "field", "bake", "write"}));
}

// The k and b that a search found are those of the asset and of the report.
TEST(Asset, RecordsTheShapeThatAFitFound) {
  const TestFolder folder;
  const Written w = write(folder, folder.write("a.obj", objText(ballMesh(1, 1))), {"rays=36", "voxels=24", "lobe=fit", "exponent=fit"});
  EXPECT_EQ(w.asset.info.lobe, "fit");
  EXPECT_EQ(w.asset.info.shape.exponent, w.report.info.shape.exponent);
  EXPECT_NE(w.asset.info.shape.exponent, 4) << "where the search starts";
  EXPECT_FALSE(w.report.fit.empty());
}

// Each in a field of its own; L, k, b and σ are the whole file's, so that they are given here.
TEST(Asset, SeparateObjectsAreBakedAsIfAlone) {
  const TestFolder folder;
  const std::vector<SculptPart> parts = twoBoxes();
  const std::vector<std::string> texts{"rays=36", "voxel-size=0.1", "ray-length=4"};
  std::vector<std::string> apart = texts;
  apart.push_back("separate");
  const fs::path both = writeParts(folder, "both.glb", parts);
  const Written separate = write(folder, both, apart, "separate.glb"), whole = write(folder, both, texts, "whole.glb"),
                first = write(folder, writeParts(folder, "first.glb", {parts[0]}), texts, "1.glb"),
                second = write(folder, writeParts(folder, "second.glb", {parts[1]}), texts, "2.glb");
  std::vector<Lobe> alone = first.asset.lobes;
  alone.insert(alone.end(), second.asset.lobes.begin(), second.asset.lobes.end());
  expectSameLobes(separate.asset.lobes, alone);
  EXPECT_TRUE(separate.asset.info.separate);
  float most = 0;
  for (size_t v = 0; v < alone.size(); ++v)
    most =
        std::max(most, length(alone[v].direction * alone[v].thickness - whole.asset.lobes[v].direction * whole.asset.lobes[v].thickness));
  EXPECT_GT(most, 0.3) << "they occlude each other where they are baked as one";
}

TEST(Asset, AnOutputDependsOnNothingElse) {
  const TestFolder folder;
  const fs::path sculpt = writeParts(folder, "a.glb", twoBoxes());
  write(folder, sculpt, {"rays=36", "voxels=24"}, "1.glb");
  write(folder, sculpt, {"rays=36", "voxels=24"}, "2.glb");
  EXPECT_EQ(readFileBytes(folder.path / "1.glb"), readFileBytes(folder.path / "2.glb"));
}

// Warnings are errors then, and neither the asset nor its lattice is touched.
TEST(Asset, StrictRefusesBeforeAnythingIsWritten) {
  const TestFolder folder;
  SurfaceMesh open = boxMesh({0, 0, 0}, {1, 1, 1});
  open.triangles.pop_back();
  const fs::path sculpt = folder.write("open.obj", objText(open));
  folder.write("out.glb", "old");
  const std::vector<std::string> texts{"rays=36", "voxels=24", "basis=sh1", "lattice=" + (folder.path / "l.json").string()};
  std::vector<std::string> strict = texts;
  strict.push_back("strict");
  expectError<InputError>([&] { write(folder, sculpt, strict); }, "--strict");
  EXPECT_EQ(readFileBytes(folder.path / "out.glb"), "old");
  EXPECT_FALSE(fs::exists(folder.path / "l.json"));
  write(folder, sculpt, texts);
  EXPECT_TRUE(fs::exists(folder.path / "l.json")) << "without --strict the same is written";
}

TEST(Asset, HarmonicsAndTheirLattice) {
  const TestFolder folder;
  const Written w = write(folder, folder.write("a.obj", objText(ballMesh(1, 1))),
                          {"rays=36", "voxels=24", "basis=sh2", "lattice-cells=4", "lattice=" + (folder.path / "cells.json").string()});
  EXPECT_EQ(w.asset.info.harmonic_order, 2);
  EXPECT_EQ(w.asset.harmonics.size(), 9 * w.asset.lobes.size());
  const Json lattice = Json::parse(readFileBytes(folder.path / "cells.json"));
  EXPECT_EQ(lattice["schema"], "cloudbake-lattice-1");
  for (const char* name : {"cells.0.ktx2", "cells.1.ktx2", "cells.2.ktx2"}) EXPECT_TRUE(fs::exists(folder.path / name)) << name;
}

TEST(Asset, PartsThinnerThanAVoxelAreTold) {
  const TestFolder folder;
  const auto thin = [&](float thickness, const std::string& name) {
    const Written w = write(folder, folder.write(name, objText(boxMesh({0, 0, 0}, {1, thickness, 1}))), {"rays=16", "voxels=24"});
    const auto found = w.report.warnings.entries().find(WarningKind::kThinPart);
    return found == w.report.warnings.entries().end() ? std::pair(uint64_t(0), std::string())
                                                      : std::pair(found->second.count, found->second.first);
  };
  const auto [count, where] = thin(0.01F, "plate.obj");
  EXPECT_EQ(count, 8U);
  EXPECT_TRUE(contains(where, "first at vertex 0 of 'plate'")) << where;
  EXPECT_EQ(thin(0.3F, "slab.obj").first, 0U);
}

TEST(Asset, ErrorsNameTheSculpt) {
  const TestFolder folder;
  const fs::path sculpt = folder.write("a.obj", objText(boxMesh({0, 0, 0}, {1, 1, 1})));
  EXPECT_EQ(refusalOf<InputError>([&] { write(folder, sculpt, {"voxels=1000000000"}); }).find(sculpt.string() + ": "), 0U);
  EXPECT_FALSE(fs::exists(folder.path / "out.glb"));
  EXPECT_FALSE(refusalOf<IoError>([&] { write(folder, folder.path / "no.obj", {}); }).empty());
}

TEST(Asset, OptionsOfTheOutputReachIt) {
  const TestFolder folder;
  const fs::path sculpt = folder.write("a.obj", objText(boxMesh({0, 0, 0}, {1, 1, 1})));
  const Written plain = write(folder, sculpt, {"rays=16", "voxels=24"}, "1.glb"),
                third = write(folder, sculpt, {"rays=16", "voxels=24", "uv-set=2", "attribute"}, "2.glb");
  EXPECT_EQ(plain.asset.info.first_uv_set, 0);
  EXPECT_EQ(third.asset.info.first_uv_set, 2);
  EXPECT_FALSE(contains(readFileBytes(folder.path / "1.glb"), "_OCCLUSION"));
  EXPECT_TRUE(contains(readFileBytes(folder.path / "2.glb"), "_OCCLUSION"));
}

}  // namespace
}  // namespace cloudbake
