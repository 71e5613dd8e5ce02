// The plan of a batch: expands a manifest, a folder or a list of sculpts to one entry per asset.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "pipeline/options/options.h"
#include "pipeline/options/scene_needs.h"
#include "pipeline/sequence/frames.h"

namespace cloudbake {

/// One asset to make.
struct PlannedAsset {
  std::string name;                      ///< of the output, relative to the output folder
  bool is_named_by_file = false;         ///< the name has the stem of a file, so that other_names may replace it
  std::vector<std::string> other_names;  ///< if another asset has the same name (pipeline/batch/names.h)
  size_t levels = 0;                     ///< of detail, which are outputs too: levelNames
  std::string source;                    ///< for messages: "preset humilis, seed 7", or a path
  SourceSettings from;                   ///< of a sequence of files: its first frame
  bool is_sequence = false;              ///< baked as `cloudbake sequence` does
  std::vector<FrameInput> frames;        ///< of a sequence of files
  std::vector<Given> given;              ///< options that were set for it, in order
  double cost_seconds = 0;               ///< estimate, on one thread
  uint64_t memory = 0;                   ///< bytes, estimated upper limit
  std::string file;                      ///< the file that asks for it; empty: none
  int line = 0, column = 0;
};

/// The names of the first levels of an output: "a/b_lod1.glb", … of "a/b.glb".
std::vector<std::string> levelNames(const std::string& name, size_t levels);

struct BatchPlan {
  std::string source;  ///< the manifest, the folder or the list
  std::vector<PlannedAsset> assets;
  std::optional<SceneNeeds> scene;
  std::vector<std::filesystem::path> watched;  ///< the manifest, and the folders that were searched
  std::set<std::filesystem::path> reports;     ///< of this run, canonical
  std::vector<std::string> notes;              ///< for people: names that several files had, files without a reader
};

/// Reads the manifest (or lists the folder, or reads the list) and expands globs, seeds and names. `given` are the options of the command
/// line; they override the manifest. Throws InputError with file, line and column for an option that is unknown or does not apply, a value
/// out of range, a missing file, two assets with the same name, or an asset that would replace an input; UsageError for the command line.
BatchPlan planBatch(const Settings& settings, std::span<const Given> given);

/// The scene that an asset is for: from its own --scene, which asset.from.read.read_file reads, else from the manifest's [scene].
std::optional<SceneNeeds> sceneOf(const PlannedAsset& asset, const BatchPlan& plan);
/// The file of the asset's own --scene.
std::optional<std::filesystem::path> sceneFileOf(const PlannedAsset& asset);

/// The assets of part `shard`, counted from 1, of `shards`. The most expensive assets are dealt out first, each to the part with the least
/// cost so far.
std::vector<PlannedAsset> shardOf(const std::vector<PlannedAsset>& assets, int shard, int shards);

/// A commented manifest to start from.
std::string exampleManifest();

}  // namespace cloudbake
