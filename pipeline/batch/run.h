// The work of a batch: takes stale assets from the cache or bakes them, in parallel.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "io/report/batch_report.h"
#include "pipeline/batch/plan.h"
#include "pipeline/batch/state.h"

namespace cloudbake {

/// Receives the progress of a batch, from any thread.
class BatchListener {
 public:
  virtual ~BatchListener() = default;
  /// `assets` assets will be baked, or then drawn, with an estimated total of `cost_seconds`.
  virtual void begin(size_t assets, double cost_seconds) = 0;
  virtual void start(const std::string& name, int stages) = 0;
  virtual void stage(const std::string& name, const std::string& finished) = 0;
  /// One asset is done; `line` describes the result, and is empty for a picture.
  virtual void finish(const std::string& name, double cost_seconds, const std::string& line) = 0;
  /// One asset has stopped, to run again when the others are done.
  virtual void postpone(const std::string& name) = 0;
  /// Receives whole lines: warnings and failures.
  virtual void tell(const std::string& lines) = 0;
};

/// One record per asset: kFresh with what is known about it, or kNotRun with the reason why it must be baked. An asset is also stale if its
/// error is needed (settings.judge.bounds) but not known.
std::vector<AssetRecord> judgeAssets(const std::vector<PlannedAsset>& assets, const std::vector<AssetInputs>& inputs,
                                     const Settings& settings);

/// Bakes the assets that are kNotRun, and marks those that exceed a bound as failed. Their inputs are read anew, because somebody may have
/// saved a file since they were judged: `inputs` and the keys of the records become those of the bytes that are baked. `stop` is the number
/// of a signal that was received, or −1 after a failure with --fail-fast; once it is set, nothing new is started.
void runAssets(const std::vector<PlannedAsset>& assets, std::vector<AssetInputs>& inputs, const BatchPlan& plan, const Settings& settings,
               std::atomic<int>& stop, BatchListener& listener, std::vector<AssetRecord>& records);

}  // namespace cloudbake
