// The work of a batch: what is stale is taken from the cache or baked, in parallel.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "io/report/batch_report.h"
#include "pipeline/batch/plan.h"
#include "pipeline/batch/state.h"

namespace cloudbake {

/// What hears of a batch's progress, from any thread.
class BatchListener {
 public:
  virtual ~BatchListener() = default;
  /// `assets` of `cost_seconds` together, roughly, are to come.
  virtual void begin(size_t assets, double cost_seconds) = 0;
  virtual void start(const std::string& name, int stages) = 0;
  virtual void stage(const std::string& name, const std::string& finished) = 0;
  /// One asset is done; `line` says how.
  virtual void finish(const std::string& name, double cost_seconds, const std::string& line) = 0;
  /// Whole lines: warnings and failures.
  virtual void tell(const std::string& lines) = 0;
};

/// Whether each asset is fresh, as a record: kFresh with what is known of it, or kNotRun with the reason why it must be baked. An asset
/// whose error is asked for (settings.judge.bounds) and not known is stale.
std::vector<AssetRecord> judgeAssets(const std::vector<PlannedAsset>& assets, const std::vector<AssetInputs>& inputs,
                                     const Settings& settings);

/// Bakes those that are kNotRun, and fails whatever is over a bound. `stop`: the number of a signal that came, or −1 after a failure with
/// --fail-fast; then nothing new is started.
void runAssets(const std::vector<PlannedAsset>& assets, const BatchPlan& plan, const Settings& settings, std::atomic<int>& stop,
               BatchListener& listener, std::vector<AssetRecord>& records);

}  // namespace cloudbake
