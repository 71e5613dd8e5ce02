// The result of `check`, as text and as JSON (docs/check.md).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/figures.h"
#include "io/gltf/validate_asset.h"
#include "io/report/figures.h"
#include "io/report/report.h"
#include "pipeline/check/diagnose.h"

namespace cloudbake {

/// Figures of a sample of an asset's lobes against the truth.
struct CheckFigures {
  BakeFigures bake;                       ///< is_fit: judged as a fitted lobe
  size_t lights = 0;                      ///< number of lights that it was judged by
  double mean_rms = 0, best_fit_rms = 0;  ///< of a fitted asset: rms of the light of the exact mean lobe, and of a lobe fitted to the truth
};

/// An asset compared with what it was before another program.
struct ComparisonFigures {
  std::string before;
  uint64_t matched = 0, added = 0, lost = 0;  ///< vertices: in both, only in the asset, only before
  BakeFigures difference;                     ///< between the asset's lobes and those before
  double density_max = 0;                     ///< largest difference of d, as a fraction of the mean d before
  std::string sets_before, sets, materials_before, materials;
};

struct CheckReport {
  BakeReport run;  ///< input, metadata, counts, seconds, warnings
  AssetExamination file;
  std::optional<CheckFigures> figures;
  std::optional<ComparisonFigures> comparison;
  std::optional<Diagnosis> diagnosis;
  std::vector<FigureBound> bounds;    ///< the bounds that were applied
  std::optional<AssetFault> verdict;  ///< why it fails; none: it is sound
};

std::string checkText(const CheckReport& report);
/// One JSON object, "schema": "cloudbake-check-1", keys in a fixed order.
std::string checkJson(const CheckReport& report);

}  // namespace cloudbake
