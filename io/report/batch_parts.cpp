// Names of states, warnings and figures for all reports of a batch.
#include "io/report/batch_parts.h"

#include <algorithm>

namespace cloudbake {

std::string_view stateLabel(AssetState state) {
  switch (state) {
    case AssetState::kBaked: return "baked";
    case AssetState::kFromCache: return "from the cache";
    case AssetState::kFresh: return "up to date";
    case AssetState::kFailed: return "failed";
    case AssetState::kNotRun: return "not run";
  }
  return "unknown";
}

size_t assetsIn(const BatchReport& report, AssetState state) {
  return size_t(std::count_if(report.assets.begin(), report.assets.end(), [&](const AssetRecord& asset) { return asset.state == state; }));
}

std::vector<CountedWarning> warningsOf(const AssetRecord& asset) {
  std::vector<CountedWarning> warnings;
  if (!asset.report.is_object() || !asset.report.contains("warnings")) return warnings;
  for (const Json& entry : asset.report["warnings"])
    warnings.push_back({entry.at("kind"), uint64_t(wholeNumber(entry.at("count"))), entry.at("first")});
  return warnings;
}

}  // namespace cloudbake
