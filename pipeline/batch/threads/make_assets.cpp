#include "pipeline/batch/make_assets.h"

#include <algorithm>

#include "core/parallel.h"

namespace cloudbake {

void makeAssets(std::span<const Job> jobs, uint64_t memory, std::atomic<int>& stop, const AssetRun& run, const AssetSteps& steps) {
  runJobs(jobs, memory, stop, [&](size_t i) {
    const AssetSlot slot = steps.start(i);
    if (makeAsset(slot.asset, std::min(jobs[i].memory, memory), jobs[i].memory < memory, run, slot.inputs, slot.record))
      steps.end(i, "");
    else
      steps.postpone(i);
  });
}

void helpIfHelper(const Settings& /*settings*/, std::span<const Given> /*given*/) {}

size_t assetsAtOnce(const Settings& /*settings*/) { return threadCount(); }

}  // namespace cloudbake
