// The part of a batch that differs between systems: who makes the assets. On most these are threads; the program for Node, whose copies
// have one thread each, has several copies (wasm/make_assets.cpp).
#pragma once

#include <atomic>
#include <functional>
#include <span>
#include <string>

#include "pipeline/batch/run.h"
#include "pipeline/batch/schedule.h"

namespace cloudbake {

/// What the assets of one run share.
struct AssetRun {
  const BatchPlan& plan;
  const Settings& settings;
  BatchListener& listener;
};

/// Makes one asset: `record` gets its name, its result and its figures. Returns whether it is done, well or not. It is not if it needs more
/// memory than these bytes, and may have more.
bool makeAsset(const PlannedAsset& asset, uint64_t memory, bool may_have_more, const AssetRun& run, AssetInputs& inputs,
               AssetRecord& record);

/// An asset, and where its result goes.
struct AssetSlot {
  const PlannedAsset& asset;
  AssetInputs& inputs;
  AssetRecord& record;
};

/// What happens beside the work on job `i`, from any thread.
struct AssetSteps {
  std::function<AssetSlot(size_t i)> start;
  std::function<void(size_t i)> postpone;
  std::function<void(size_t i, const std::string& crash)> end;  ///< `crash` says how the asset crashed the copy of the program that made it
};

/// Makes assets by makeAsset, each within its memory, with no more at once than fit into `memory` together (runJobs). Once `stop` is set,
/// none is started; a copy of the program sets it itself.
void makeAssets(std::span<const Job> jobs, uint64_t memory, std::atomic<int>& stop, const AssetRun& run, const AssetSteps& steps);

/// In a copy of the program that makes assets for another, makes them until that ends it; else does nothing.
void helpIfHelper(const Settings& settings, std::span<const Given> given);

/// How many assets are made at once.
size_t assetsAtOnce(const Settings& settings);

}  // namespace cloudbake
