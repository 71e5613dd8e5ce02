// Surfaces of grown clouds, of volumes and of sculpts are valid at every size. CLOUDBAKE_SWEEP=N in the environment takes N seeds per
// preset instead of one, and finer lattices; the default is what a change should not have to wait for.
#include <array>
#include <cstdlib>
#include <map>

#include "bake/field/level_set.h"
#include "bake/mesh/surface.h"
#include "core/random.h"
#include "pipeline/sources/grown.h"
#include "pipeline/sources/presets.h"
#include "tests/mesh_validity.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"
#include "tests/warnings.h"

namespace cloudbake {
namespace {

// The number of seeds, if a sweep was asked for.
std::optional<uint64_t> sweepSeeds() {
  const char* text = std::getenv("CLOUDBAKE_SWEEP");
  return text ? std::optional<uint64_t>(std::strtoull(text, nullptr, 10)) : std::nullopt;
}

Cloud grownCloud(const char* preset, const std::vector<std::string>& texts) {
  const SourceSettings from = sourceOf(SourceKind::kPreset, preset);
  GrownSource source = readGrownSource(from);
  std::vector<Given> given = source.given;
  for (const Given& one : options(texts, kGrow)) given.push_back(one);
  BakeReport report;
  Stopwatch watch;
  return growCloud(std::move(source), resolve(from, given), std::nullopt, report, watch);
}

struct Tally {
  size_t meshes = 0, missed = 0, faulty = 0;
};

// A surface of as many vertices as asked, or with a reason why not.
void checkSurface(const LevelSet& level_set, std::optional<size_t> budget, size_t full, const std::string& what, Tally& tally) {
  Warnings warnings;
  const SurfaceMesh mesh = meshFromLevelSet(level_set, {budget}, warnings);
  const MeshFaults faults = faultsOf(mesh);
  EXPECT_EQ(faults.count(), 0U) << what << ": " << faults;
  EXPECT_GT(signedVolume(mesh), 0) << what;
  ++tally.meshes, tally.faulty += faults.count() > 0;
  if (!budget) return;
  const size_t expected = std::min(*budget, full);
  const bool is_missed = mesh.positions.size() > expected;
  tally.missed += is_missed;
  EXPECT_GE(mesh.positions.size(), expected) << what;
  EXPECT_EQ(countOf(warnings, WarningKind::kVertexBudget), is_missed ? 1U : 0U) << what << ": " << mesh.positions.size();
}

// Where the surface is one ball-like body, every budget that has a use is met.
TEST(GrownSurface, IsValidForEveryPresetSeedLatticeAndBudget) {
  const uint64_t seeds = sweepSeeds().value_or(1);
  const std::vector<int> lattices = sweepSeeds() ? std::vector{40, 100, 237} : std::vector{40, 100};
  Tally tally;
  for (const Preset& preset : presets())
    for (uint64_t seed = 1; seed <= seeds; ++seed)
      for (const int voxels : lattices) {
        const std::string name = std::string(preset.name) + " --seed " + std::to_string(seed) + " --voxels " + std::to_string(voxels);
        const Cloud cloud = grownCloud(preset.name, {"seed=" + std::to_string(seed), "voxels=" + std::to_string(voxels)});
        const size_t full = cloud.surface.positions.size();
        for (const size_t budget : {size_t(0), full / 2, size_t(10000), size_t(3000), size_t(300)})
          checkSurface(*cloud.level_set, budget > 0 ? std::optional(budget) : std::nullopt, full,
                       name + " --vertices " + std::to_string(budget), tally);
      }
  std::printf("[  figures ] %zu surfaces, %zu with faults, %zu budgets missed\n", tally.meshes, tally.faulty, tally.missed);
}

}  // namespace
}  // namespace cloudbake
