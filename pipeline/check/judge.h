// The verdict on an asset that was measured (docs/check.md).
#pragma once

#include <optional>
#include <vector>

#include "pipeline/check/measure_asset.h"

namespace cloudbake {

/// The bounds of the figures against the truth: those that were asked for, or the default ones.
std::vector<FigureBound> boundsFor(const CheckFigures& figures, const ErrorBounds& asked);

/// Metadata that no bake of this shape writes, or with which nothing is to be seen.
std::optional<AssetFault> oddConstants(const AssetInfo& info, const SurfaceMesh& surface);

/// A mesh that is not the one of the bake, if the seal says so and says that the constants are. They may then look odd beside the mesh.
std::optional<AssetFault> staleFault(const std::optional<SealDifference>& seal);

/// Why the asset fails; none if it is sound. Adds notes on harmless changes to report.file.harmless.
std::optional<AssetFault> judge(const CheckedAsset& asset, const AssetSample& sample, CheckReport& report);

}  // namespace cloudbake
