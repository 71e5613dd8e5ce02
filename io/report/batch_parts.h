// What the reports of a batch for people and for build servers have in common.
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
/// Of an asset's report; none where there is no report. Precondition: the report is as reportJson writes it, or was read by readBatchJson.
std::vector<CountedWarning> warningsOf(const AssetRecord& asset);

/// How an error figure is named, stored and told.
struct FigureField {
  const char* key;    ///< in JSON
  const char* label;  ///< for people
  const char* unit;
  double scale;  ///< from the stored value to the unit
  bool may_be_negative;
  double AssetFigures::*value;
};
inline constexpr FigureField kFigureFields[] = {
    {"direction_rms_degrees", "direction rms", "°", 1, false, &AssetFigures::direction_rms_degrees},
    {"direction_median_degrees", "direction median", "°", 1, false, &AssetFigures::direction_median_degrees},
    {"direction_p95_degrees", "direction p95", "°", 1, false, &AssetFigures::direction_p95_degrees},
    {"direction_max_degrees", "direction max", "°", 1, false, &AssetFigures::direction_max_degrees},
    {"density_rms", "density rms", "%", 100, false, &AssetFigures::density_rms},
    {"density_bias", "density bias", "%", 100, true, &AssetFigures::density_bias},
    {"transmittance_rms", "transmittance rms", "%", 100, false, &AssetFigures::transmittance_rms},
    {"transmittance_bias", "transmittance bias", "%", 100, true, &AssetFigures::transmittance_bias},
};

/// Three significant digits and the unit; "undefined" for what is no finite number.
std::string figureText(const FigureField& field, const AssetFigures& figures);

}  // namespace cloudbake
