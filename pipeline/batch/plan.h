// What a batch is to make: a manifest, a folder or a list of sculpts, as one entry per asset.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/warnings.h"
#include "pipeline/options.h"
#include "pipeline/scene_needs.h"

namespace cloudbake {

/// One asset to be made.
struct PlannedAsset {
  std::string name;    ///< of the output, relative to the output folder
  std::string source;  ///< for people: "preset humilis, seed 7", or a path
  SourceSettings from;
  std::vector<Given> given;  ///< options that were set for it, in order
  double cost_seconds = 0;   ///< roughly, on one thread
  uint64_t memory = 0;       ///< bytes, roughly, at most
  std::string file;          ///< where it is asked for; empty: nowhere in particular
  int line = 0, column = 0;
};

struct BatchPlan {
  std::string source;  ///< the manifest, the folder or the list
  std::vector<PlannedAsset> assets;
  std::optional<SceneNeeds> scene;
  Warnings warnings;                           ///< of the manifest
  std::vector<std::filesystem::path> watched;  ///< the manifest, and the folders that were looked into
};

/// Reads the manifest (or lists the folder, or reads the list) and expands globs, seeds and names. `given` is what the command line set; it
/// goes over the manifest. Throws InputError with file, line and column: an unknown or unsuitable option, a value out of range, a missing
/// file, two assets of one name, an asset that would replace an input; UsageError for the command line.
BatchPlan planBatch(const Settings& settings, std::span<const Given> given);

/// What a camera needs of the asset: of its own --scene, else of the manifest's [scene].
std::optional<SceneNeeds> sceneOf(const PlannedAsset& asset, const BatchPlan& plan, Warnings& warnings);
/// The file of its own --scene.
std::optional<std::filesystem::path> sceneFileOf(const PlannedAsset& asset);

/// The assets of part `shard` of `shards`: dealt out in order of their cost, each to the part that has least so far.
std::vector<PlannedAsset> shardOf(const std::vector<PlannedAsset>& assets, int shard, int shards);

/// A commented manifest to begin with.
std::string exampleManifest();

}  // namespace cloudbake
