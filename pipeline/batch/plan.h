// What a batch is to make: a manifest, a folder or a list of sculpts, as one entry per asset.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/commands.h"
#include "pipeline/options.h"

namespace cloudbake {

/// An option of an asset, and where it was set.
struct AssetOption {
  const Option* option = nullptr;
  std::string value;
  std::string file;  ///< empty: on the command line
  int line = 0, column = 0;
};

/// One asset to be made.
struct PlannedAsset {
  std::string name;    ///< of the output, relative to the output folder
  std::string source;  ///< for people: "preset humilis, seed 7", or a path
  InputKind kind = InputKind::kSculpt;
  CloudSourceKind source_kind = CloudSourceKind::kSculpt;
  std::filesystem::path input;  ///< file, or name of a preset
  std::vector<AssetOption> options;
  double cost_seconds = 0;  ///< roughly, on one thread
  uint64_t memory = 0;      ///< bytes, roughly, at most
  std::string file;         ///< where it is asked for; empty: nowhere in particular
  int line = 0, column = 0;
};

bool isGrown(const PlannedAsset& asset);

struct BatchPlan {
  std::string source;  ///< the manifest, the folder or the list
  std::vector<PlannedAsset> assets;
  std::optional<SceneView> scene;
  std::vector<std::filesystem::path> watched;  ///< the manifest, and the folders that were looked into
};

/// Reads the manifest (or lists the folder, or reads the list) and expands globs, seeds and names. `given` is what the command line set; it
/// goes over the manifest. Throws InputError with file, line and column: an unknown or unsuitable option, a value out of range, a missing
/// file, two assets of one name, an asset that would replace an input; UsageError for the command line.
BatchPlan planBatch(const Settings& settings, const std::vector<AssetOption>& given);

/// The settings that the asset is baked with. `apply` (what growScene takes) sets them again, over a recipe's own.
Settings settingsOf(const PlannedAsset& asset, const BatchPlan& plan, const Settings& batch);
void applyOptions(const PlannedAsset& asset, Settings& settings);

/// The assets of part `shard` of `shards`: dealt out in order of their cost, each to the part that has least so far.
std::vector<PlannedAsset> shardOf(const std::vector<PlannedAsset>& assets, int shard, int shards);

/// A commented manifest to begin with.
std::string exampleManifest();

}  // namespace cloudbake
