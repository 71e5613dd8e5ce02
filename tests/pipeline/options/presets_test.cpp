#include "pipeline/options/presets.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "io/file/write_file.h"
#include "pipeline/fields/fields.h"
#include "pipeline/sources/grown.h"
#include "tests/folders.h"
#include "tests/pipeline/pipeline_helpers.h"

namespace cloudbake {
namespace {

namespace fs = std::filesystem;

// The binary carries every recipe of data/presets, as the files are.
TEST(Presets, AreTheFilesOfTheirFolder) {
  size_t files = 0;
  for (const auto& entry : fs::directory_iterator(sourceFolder() / "data/presets")) {
    ++files;
    const auto preset = findPreset(entry.path().stem().string());
    ASSERT_TRUE(preset) << entry.path();
    EXPECT_EQ(*preset, readFileBytes(entry.path()));
  }
  EXPECT_EQ(presets().size(), files);
  EXPECT_FALSE(findPreset("nimbus") || findPreset("") || findPreset("humilis.toml"));
}

TEST(Presets, NamesAreSortedAndJoined) {
  std::string joined;
  for (const Preset& preset : presets()) {
    EXPECT_TRUE(joined.empty() || joined.substr(joined.rfind(' ') + 1) < preset.name) << preset.name;
    joined += (joined.empty() ? "" : ", ") + std::string(preset.name);
  }
  EXPECT_EQ(presetNames(), joined);
}

// Every one is a recipe whose options the table takes, and grows at once. Those of several pieces say whether pieces are meant.
TEST(Presets, AllGrow) {
  for (const Preset& preset : presets()) {
    const SourceSettings from = sourceOf(SourceKind::kPreset, preset.name);
    GrownSource source = readGrownSource(from);
    EXPECT_EQ(source.bytes, preset.toml);
    std::vector<Given> given = source.given;
    given.push_back(option("dry-run", kGrow));
    const Settings settings = resolve(from, given);
    BakeReport report;
    Stopwatch watch;
    const Cloud cloud = growCloud(std::move(source), settings, std::nullopt, report, watch);
    EXPECT_GT(cloud.spheres.size(), 10U) << preset.name;
    EXPECT_LT(cloud.spheres.size(), 2000U) << preset.name;
    EXPECT_TRUE(report.warnings.empty()) << preset.name << ": " << warningLines(report);
    ASSERT_TRUE(report.growth);
    EXPECT_EQ(report.growth->parts == 1 || report.growth->connected, !contains(preset.toml, "connect = false")) << preset.name;
  }
}

// No sphere is under 1.5 voxels of the lattice that its preset asks for, which would be a warning in every such seed.
TEST(Presets, SpheresOfAllSeedsAreLargeEnoughForTheVoxels) {
  for (const Preset& preset : presets())
    for (int seed = 1; seed <= 12; ++seed) {
      GrownSource source = readGrownSource(sourceOf(SourceKind::kPreset, preset.name));
      std::vector<Given> given = source.given;
      given.push_back(option("seed=" + std::to_string(seed), kGrow));
      given.push_back(option("dry-run", kGrow));
      const Settings settings = resolve(sourceOf(SourceKind::kPreset, preset.name), given);
      BakeReport report;
      Stopwatch watch;
      const Cloud cloud = growCloud(std::move(source), settings, std::nullopt, report, watch);
      float least = INFINITY;
      for (const Sphere& sphere : cloud.spheres) least = std::min(least, sphere.radius);
      const float voxel = boundingBox(cloud.spheres).longestSide() / float(settings.field.voxels);
      EXPECT_GT(least, 1.5F * voxel) << preset.name << ", seed " << seed;
    }
}

}  // namespace
}  // namespace cloudbake
