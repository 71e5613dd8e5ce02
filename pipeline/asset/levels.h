// Levels of detail: the same cloud with fewer vertices, each level an asset of its own.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "io/report/report.h"
#include "pipeline/fields/cloud.h"
#include "pipeline/fields/stopwatch.h"
#include "pipeline/options/settings.h"
#include "preview/compare/popping.h"

namespace cloudbake {

/// "cloud_lod1.glb" for level 1 of "cloud.glb".
std::filesystem::path levelFile(const std::filesystem::path& output, size_t level);

/// The baked assets and impostors that are named as levels of this output beyond its last one: an earlier bake or plan with more levels has
/// left them.
std::vector<std::filesystem::path> staleLevels(const std::filesystem::path& output, size_t levels);

/// A level as the bytes of its GLB.
struct LevelAsset {
  std::filesystem::path file;
  std::string glb;
  std::vector<SizeChange> changes;  ///< of the picture, by the level
};

/// Simplifies a baked cloud to each of settings.mesh.levels, and records the levels in the report, which must have the info of the full
/// asset. `lobes` and `harmonics` are those of the full asset (harmonics may be empty). A vertex keeps its place, so it keeps its lobe:
/// that is the bake of the level in the field of the full cloud. Counts kPartKept and kVertexBudget.
std::vector<LevelAsset> makeLevels(const Cloud& cloud, std::span<const Lobe> lobes, std::span<const float> harmonics,
                                   const Settings& settings, BakeReport& report, Stopwatch& watch);

}  // namespace cloudbake
