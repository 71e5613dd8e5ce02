// Code shared by the reports of a batch for people and for build servers.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/report/batch_report.h"

namespace cloudbake {

/// A state in words: "baked", "from the cache", "up to date", "failed", "not run".
std::string_view stateLabel(AssetState state);

inline constexpr AssetState kAssetStates[] = {AssetState::kBaked, AssetState::kFromCache, AssetState::kFresh, AssetState::kFailed,
                                              AssetState::kNotRun};

size_t assetsIn(const BatchReport& report, AssetState state);

/// An entry of "warnings" in a "cloudbake-report-1".
struct CountedWarning {
  std::string kind;
  uint64_t count = 0;
  std::string first;
};
/// The warnings of an asset's report; none if there is no report. Precondition: the report was written by reportJson or read by
/// readBatchJson.
std::vector<CountedWarning> warningsOf(const AssetRecord& asset);

}  // namespace cloudbake
