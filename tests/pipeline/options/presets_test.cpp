#include "pipeline/options/presets.h"

#include <filesystem>

#include "io/file/write_file.h"
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

}  // namespace
}  // namespace cloudbake
