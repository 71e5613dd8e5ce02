// A VDB as a cloud: the file's own lattice is what the bake integrates on.
#include "pipeline/sources/volume.h"

#include "bake/field/level_set.h"
#include "core/level_set_type.h"
#include "io/file/write_file.h"
#include "io/volume/vdb.h"
#include "pipeline/asset/asset.h"
#include "tests/io/io_helpers.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

namespace fs = std::filesystem;

constexpr float kVoxel = 0.11F;

fs::path writeBall(const TestFolder& folder, Vec3 center = {}) {
  LevelSetSettings settings;
  settings.voxel_size = kVoxel;
  Warnings warnings;
  return folder.write("puff.vdb", encodeVdb(levelSetFromMesh(ballMesh(1, 3, center), settings, warnings)));
}

struct VolumeRead {
  Cloud cloud;
  BakeReport report;
  Settings settings;
};
VolumeRead readVdbCloud(const fs::path& file, const std::vector<std::string>& texts = {}) {
  VolumeRead r;
  r.settings = settingsFor(texts, SourceKind::kVolume, file);
  Stopwatch watch;
  r.cloud = readCloud(r.settings, r.report, watch);
  return r;
}

TEST(Volume, IsTheSurfaceOfItsLevelSet) {
  const TestFolder folder;
  const fs::path file = writeBall(folder, {3, 0, -2});
  const VolumeRead r = readVdbCloud(file);
  EXPECT_TRUE(r.cloud.closed && r.cloud.level_set && !r.cloud.exact_spheres);
  EXPECT_NEAR(signedVolume(r.cloud.surface), 4 * kPi / 3, 0.1);
  for (const Vec3& p : r.cloud.surface.positions) ASSERT_NEAR(length(p - Vec3{3, 0, -2}), 1, kVoxel / 2);
  ASSERT_EQ(r.cloud.sculpt.parts.size(), 1U);
  EXPECT_EQ(r.cloud.sculpt.parts[0].name, "puff");
  EXPECT_EQ(r.report.info.input_hash, hashBytes(readFileBytes(file)));
  EXPECT_EQ(r.report.input, file.string());
}

TEST(Volume, TheFilesVoxelsAreIntegratedUnlessOthersAreGiven) {
  const TestFolder folder;
  const fs::path file = writeBall(folder);
  const auto voxelOf = [&](const std::vector<std::string>& texts) {
    VolumeRead r = readVdbCloud(file, texts);
    Stopwatch watch;
    const BakeParameters parameters = resolveParameters(r.cloud, r.settings, r.report, watch);
    const IntegrationField field = fieldOfCloud(r.cloud, r.settings, parameters, r.report, watch);
    EXPECT_FLOAT_EQ(r.report.info.voxel_size, float(field.voxelSize()));
    return field.voxelSize() / boundingBox(r.cloud.surface).longestSide();
  };
  EXPECT_NEAR(*readVdbCloud(file).cloud.voxel_size, kVoxel, 1e-7);
  const double longest = boundingBox(readVdbCloud(file).cloud.surface).longestSide();
  for (const char* method : {"method=sweep", "method=rays"}) {
    EXPECT_NEAR(voxelOf({method}), kVoxel / longest, 1e-6) << method;
    EXPECT_NEAR(voxelOf({method, "bake-voxels=25"}), 1.0 / 25, 1e-6) << method;
  }
}

TEST(Volume, AClippedLevelSetIsAClosedCloud) {
  const TestFolder folder;
  LevelSetSettings settings;
  settings.voxel_size = kVoxel;
  Warnings warnings;
  const LevelSet ball = levelSetFromMesh(ballMesh(1, 3), settings, warnings);
  ball.grid->vdb->tree().clip({{-100, -100, -3}, {100, 100, 100}});
  const VolumeRead r = readVdbCloud(folder.write("puff.vdb", encodeVdb(ball)));
  EXPECT_TRUE(r.cloud.closed);
  EXPECT_EQ(r.report.warnings.entries().count(WarningKind::kVolumeRebuilt), 1U);
  const float cut = -3.5F * kVoxel;
  for (const Vec3& p : r.cloud.surface.positions) {
    ASSERT_LT(length(p), 1 + kVoxel / 2);
    ASSERT_GT(p.z, cut - kVoxel / 10);
  }
  const double height = 1 - cut, exact = kPi * height * height * (3 - height) / 3;
  EXPECT_NEAR(signedVolume(r.cloud.surface), exact, 0.05 * exact) << "nine voxels per radius: the triangles and the cap's rim lose 3 %";
}

TEST(Volume, ABudgetOfVertices) {
  const TestFolder folder;
  const fs::path file = writeBall(folder);
  EXPECT_GT(readVdbCloud(file).cloud.surface.positions.size(), 300U);
  EXPECT_LE(readVdbCloud(file, {"vertices=100"}).cloud.surface.positions.size(), 100U);
}

TEST(Volume, OptionsOfTheFileReachItsReader) {
  const TestFolder folder;
  const fs::path file = writeBall(folder);
  EXPECT_TRUE(contains(refusalOf([&] { readVdbCloud(file, {"grid=smoke"}); }), "smoke"));
  EXPECT_FALSE(refusalOf<UsageError>([&] { readVdbCloud(file, {"iso=0.5"}); }).empty()) << "a level set has no iso value";
  EXPECT_EQ(refusalOf<InputError>([&] { readVdbCloud(folder.write("no.vdb", "nonsense")); }).find((folder.path / "no.vdb").string()), 0U);
  EXPECT_FALSE(refusalOf<IoError>([&] { readVdbCloud(folder.path / "missing.vdb"); }).empty());
}

}  // namespace
}  // namespace cloudbake
