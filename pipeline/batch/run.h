// The work of a batch: what is stale is taken from the cache or baked, in parallel.
#pragma once

#include <atomic>
#include <vector>

#include "pipeline/batch/plan.h"
#include "pipeline/batch/state.h"
#include "io/report/batch_report.h"

namespace cloudbake {

/// Whether each asset is fresh, as a record: kFresh with what is known of it, or kNotRun with the reason why it must be baked. An asset
/// whose error is asked for (`settings.bounds`) and not known is stale.
std::vector<AssetRecord> judgeAssets(const std::vector<PlannedAsset>& assets, const std::vector<AssetInputs>& inputs,
                                     const Settings& settings);

/// Bakes those that are kNotRun, and fails whatever is over a bound. `stop`: the number of a signal that came, or −1 after a failure with
/// --fail-fast; then no more are begun.
void runAssets(const std::vector<PlannedAsset>& assets, const BatchPlan& plan, const Settings& settings, std::atomic<int>& stop,
               std::vector<AssetRecord>& records);

}  // namespace cloudbake
